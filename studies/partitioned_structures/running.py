"""Partitioned tests in the digital laboratory, and predictions of their error beside the simulated one."""

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pandas as pd

from reliab.criterion.laws import Dimensionless
from reliab.indices.frequency_evaluation import frequency_evaluation
from reliab.progress import Progress, silent
from reliab.simulation.compensators import ModelInverse
from reliab.simulation.frames import governing_mode
from reliab.simulation.laboratory import Rig, Sensors, run_laboratory
from reliab.structures import Partition

from .drawing import RATE, PartitionedTest
from .predictions import (
    PREDICTIONS,
    by_law_18,
    by_law_with_share,
    mean_law,
    rebuilt,
    resolved,
)
from .structures import partitioned_structures


def run_tests(tests: Sequence[PartitionedTest], *, progress: Progress = silent) -> pd.DataFrame:
    """Run tests and predict the error of each in four ways.

    One row for each test: `structure`, `motion`, `f` [Hz], `xi`, `alpha` of the governing mode, `A`, `d_ms`,
    `lost`, `error` (simulated RMS^R) [-] and the predictions `law_18`, `law_with_share`, `resolved` and
    `rebuilt` [-]; missing where a law does not apply or the test was lost.
    """
    partitions, law = partitioned_structures(), mean_law()
    with ThreadPoolExecutor() as pool:
        rows = []
        for count, row in enumerate(pool.map(lambda test: _row(test, partitions, law), tests), start=1):
            rows.append(row)
            progress(count, len(tests))
    return pd.DataFrame(rows)


def _row(test: PartitionedTest, partitions: dict[str, Partition], law: Dimensionless) -> dict[str, Any]:
    partition = partitions[test.structure]
    rig = Rig(
        transfer_system=test.servo,
        compensator=ModelInverse(factors=test.inverse),
        sensors=Sensors(displacement_noise=5e-6),
    )
    run = run_laboratory(
        partition, rig, test.motion.acceleration, test.motion.time_step, rate=RATE, seed=test.seed
    )
    mode = governing_mode(partition)
    row: dict[str, Any] = {
        "structure": test.structure,
        "motion": test.motion.name,
        "f": mode.frequency,
        "xi": mode.damping_ratio,
        "alpha": mode.experimental_fraction,
        "lost": run.lost,
        **dict.fromkeys(["A", "d_ms", "error", *PREDICTIONS], math.nan),
    }
    if run.lost:
        return row
    reference = partition.direction @ run.reference
    largest = float(np.abs(reference).max())
    tracking = frequency_evaluation(run.command, run.measured, run.step, window="boxcar")
    index = tracking.amplitude, 1e3 * tracking.equivalent_delay
    return row | {
        "A": index[0],
        "d_ms": index[1],
        "error": float(np.sqrt(np.mean((run.piston - reference) ** 2))) / largest,
        "law_18": by_law_18(mode, *index),
        "law_with_share": by_law_with_share(law, mode, partition, *index),
        "resolved": resolved(run, partition, test.motion) / largest,
        "rebuilt": rebuilt(run, partition),
    }


def ratios(tests: pd.DataFrame) -> pd.DataFrame:
    """Predicted over simulated error: median ratio and scatter of each prediction.

    Columns `prediction`, `tests` that it applies to, `median` ratio, `scatter` (standard deviation of the
    ratio's logarithm), `low` and `high` (5 and 95 % of the ratios).
    """
    rows = []
    for name in PREDICTIONS:
        ratio = (tests[name] / tests["error"]).dropna()
        rows.append(
            {
                "prediction": name,
                "tests": len(ratio),
                "median": float(ratio.median()),
                "scatter": float(np.log(ratio).std()),
                "low": float(ratio.quantile(0.05)),
                "high": float(ratio.quantile(0.95)),
            }
        )
    return pd.DataFrame(rows)
