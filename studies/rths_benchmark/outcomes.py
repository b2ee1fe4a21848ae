"""The virtual hybrid-simulation benchmark: criteria J1 to J9, A and d, the error and its verdict.

The paper of the benchmark numbers J5 to J7 differently (its J5 is J6 here, its J6 is J7 and its J7 is J5).
"""

import csv
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd
from reliab_studies.laboratory.laboratory import Run, run_laboratory

from reliab.assessment.rebuild import rebuild
from reliab.assessment.verdict import word_of_probability
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.motions.motion import Motion
from reliab.structures.partition import Partition
from reliab.tracking.indices.tracking import frequency_evaluation

from .benchmark import (
    CASES,
    FORCE_LIMIT,
    RATE,
    BenchmarkPlant,
    benchmark_compensator,
    benchmark_partition,
    benchmark_plants,
    benchmark_rig,
    scale_record,
)

NOMINAL: Final = "nominal"
"""What the plant of the benchmark is called in results; others by their number."""

STANDARD: Final = ("pi_phase_lead", "inverse", "adaptive_time_series", "adaptive_model_based")
"""Compensators that the shipped study compares."""

_FORCE_LAG: Final = 1.5 / RATE  # of the order of events, and therefore known to an operator
_THINNED: Final = 4  # samples of the laboratory to one of which the error is rebuilt
_PUBLISHED_MOTION: Final = "elcentro"


@dataclass(frozen=True, kw_only=True)
class BenchmarkRequest:
    """The part of the benchmark to run.

    `threshold`: error [-] of the verdicts.
    """

    cases: tuple[int, ...] = CASES
    compensators: tuple[str, ...] = STANDARD
    perturbed: int = 20
    seed: int = 0
    threshold: float = 0.05

    def __post_init__(self) -> None:
        for case in self.cases:
            benchmark_partition(case)
        for name in self.compensators:
            benchmark_compensator(name)
        if not (self.perturbed >= 0 and self.seed >= 0 and self.threshold > 0.0):
            raise InputError(
                "Perturbed plants and seed must not be negative, and the threshold positive",
                value=f"{self.perturbed}, {self.seed}, {self.threshold}",
            )


def run_benchmark(
    motions: Sequence[Motion], request: BenchmarkRequest, *, progress: Progress = silent
) -> list[dict[str, Any]]:
    """Run every case, motion, compensator and plant in the exact variant.

    One for each test: `case`, `motion`, `compensator`, `plant` ("nominal" or a number), `lost`, `J1` [ms] to
    `J9` [%], `A`, `d_ms`, `peak_force_n`, `over_force_limit`, and `error`, the true `rms` and `mte` [-]; on
    the nominal plant `rebuilt`, the same from the test alone with its 90 % interval, the probability that
    RMS^R is below the threshold, and the `verdict`. A lost test has nulls.
    """
    plants = benchmark_plants(request.perturbed, request.seed)
    tests = list(_tests(motions, request, plants))
    rows = []
    with ThreadPoolExecutor() as pool:
        for count, row in enumerate(
            pool.map(lambda test: _row(*test, threshold=request.threshold), tests), start=1
        ):
            rows.append(row)
            progress(count, len(tests))
    return rows


def _tests(
    motions: Sequence[Motion], request: BenchmarkRequest, plants: Sequence[BenchmarkPlant]
) -> Iterator[tuple[int, Motion, str, BenchmarkPlant, int]]:
    for name in request.compensators:
        for case in request.cases:
            for motion in motions:
                for plant in plants:
                    yield case, motion, name, plant, 1000 * request.seed + plant.number


def _row(
    case: int, motion: Motion, name: str, plant: BenchmarkPlant, seed: int, *, threshold: float
) -> dict[str, Any]:
    partition = benchmark_partition(case, plant.stiffness)
    run = run_laboratory(
        partition,
        benchmark_rig(name, plant),
        scale_record(motion.acceleration),
        motion.time_step,
        rate=RATE,
        seed=seed,
    )
    row: dict[str, Any] = {
        "case": case,
        "motion": Path(motion.name).name,
        "compensator": name,
        "plant": plant.number or NOMINAL,
        "lost": run.lost,
        **dict.fromkeys([*NAMES, "A", "d_ms"]),
        "peak_force_n": float(np.abs(run.force).max()),
        "over_force_limit": bool(np.abs(run.force).max() >= FORCE_LIMIT),
        "error": None,
    }
    if run.lost:
        return row
    tracking = frequency_evaluation(run.command, run.measured, run.step, window="boxcar")
    largest = np.abs(run.reference[0]).max()
    true = run.piston - run.reference[0]
    row |= benchmark_criteria(run)
    row |= {
        "A": tracking.amplitude,
        "d_ms": 1e3 * tracking.equivalent_delay,
        "error": {
            "rms": float(np.sqrt(np.mean(true**2)) / largest),
            "mte": float(np.abs(true).max() / largest),
        },
    }
    if plant.number == 0:
        row["rebuilt"] = _rebuilt(run, partition, threshold)
    return row


def _rebuilt(run: Run, partition: Partition, threshold: float) -> dict[str, Any]:
    """Error of the test from its own command and measured displacement, and its verdict."""
    thinned = slice(None, None, _THINNED)
    error = rebuild(
        run.command[thinned].copy(),
        run.measured[thinned].copy(),
        _THINNED * run.step,
        partition,
        feedback_lag=_FORCE_LAG,
    )
    estimates = {"rms": error.rms, "mte": error.mte}
    return {
        **{
            name: {"value": estimate.value, "low": estimate.low, "high": estimate.high}
            for name, estimate in estimates.items()
        },
        "probability": error.probability(threshold),
        "verdict": str(word_of_probability(error.probability(threshold))),
    }


def compare_with_published(motion: Motion, published: pd.DataFrame, *, seeds: int = 6) -> pd.DataFrame:
    """Compare the published Table 3 with ours, over noises.

    `published`: columns `case` and `J1` … `J9`. Result: one row for each case, criterion and variant
    ("emulated" difference blocks, or "exact"): `case`, `criterion`, `variant`, `published`, `mean`, `least`,
    `most` over the noises, and `reached`, whether some noise gives the printed digits.
    """
    plant = benchmark_plants(0)[0]
    rows = []
    for emulate in (True, False):
        for case in published["case"].astype(int):
            values = pd.DataFrame(
                benchmark_criteria(
                    run_laboratory(
                        benchmark_partition(case),
                        benchmark_rig("pi_phase_lead", plant),
                        scale_record(motion.acceleration),
                        motion.time_step,
                        rate=RATE,
                        seed=seed,
                        emulate_differences=emulate,
                    )
                )
                for seed in range(seeds)
            )
            printed = published.loc[published["case"] == case, list(NAMES)].to_numpy(dtype=np.float64)[0]
            rows += [
                {
                    "case": case,
                    "criterion": name,
                    "variant": "emulated" if emulate else "exact",
                    "published": float(number),
                    "mean": float(values[name].mean()),
                    "least": float(values[name].min()),
                    "most": float(values[name].max()),
                    "reached": bool(np.any(values[name].to_numpy().round(1) == number)),
                }
                for name, number in zip(NAMES, printed.tolist(), strict=True)
            ]
    return pd.DataFrame(rows)


def find_published_motion(motions: Sequence[Motion]) -> Motion | None:
    """Return the motion of the published table, where it is among the records."""
    return next((motion for motion in motions if Path(motion.name).name.lower() == _PUBLISHED_MOTION), None)


def read_published(path: Path) -> pd.DataFrame:
    """Read the published table: columns `case` and `J1` … `J9`."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    return pd.DataFrame(rows).astype({"case": int})


def summary(rows: Sequence[dict[str, Any]]) -> pd.DataFrame:
    """Summarise tests by compensator and kind of plant.

    Columns `compensator`, `plants` ("nominal" or "perturbed"), `tests`, `lost`, `over_force_limit`, and the
    means of `J1` … `J9`, `A` and `d_ms` over the tests that were not lost.
    """
    table = pd.DataFrame(rows)
    table["plants"] = np.where(table["plant"] == NOMINAL, NOMINAL, "perturbed")
    columns = [*NAMES, "A", "d_ms"]
    table[columns] = table[columns].astype(float)
    groups = table.groupby(["compensator", "plants"], sort=False)
    counts = groups.agg(
        tests=("lost", "size"), lost=("lost", "sum"), over_force_limit=("over_force_limit", "sum")
    )
    return counts.join(groups[columns].mean()).reset_index()


NAMES: Final = tuple(f"J{number}" for number in range(1, 10))

_LONGEST_LAG = 50  # samples


def tracking_delay(command: Array, measured: Array, step: float) -> float:
    """Lag [s], from 0 to 49 samples, at which measured and command displacement correlate best.

    `command`, `measured`: displacements [m], shape (n,); `step`: step [s].

    >>> late = np.sin(0.01 * np.arange(1000))
    >>> tracking_delay(np.sin(0.01 * (np.arange(1000) + 7)), late, 1.0)
    7.0
    """
    size = command.size
    correlations = [
        np.corrcoef(command[: size - lag], measured[lag:])[0, 1] for lag in range(min(_LONGEST_LAG, size - 2))
    ]
    return float(np.argmax(correlations)) * step


def benchmark_criteria(run: Run) -> dict[str, float]:
    """J1 [ms] and J2 to J9 [%] of a test whose first three degrees of freedom are floors."""
    measured, numerical, reference = run.measured, run.floors, run.reference

    def spread(values: Array, reference: Array) -> float:
        return 100.0 * float(np.std(values, ddof=1) / np.std(reference, ddof=1))

    def peak(values: Array, reference: Array) -> float:
        return 100.0 * float(np.abs(values).max() / np.abs(reference).max())

    tracking = measured - numerical[0]
    first = measured - reference[0]
    second, third = numerical[1] - reference[1], numerical[2] - reference[2]
    values = [
        spread(tracking, numerical[0]),
        peak(tracking, numerical[0]),
        spread(first, reference[0]),
        peak(first, reference[0]),
        spread(second, reference[1]),
        spread(third, reference[2]),
        peak(second, reference[1]),
        peak(third, reference[2]),
    ]
    delay = round(1e3 * tracking_delay(numerical[0], measured, run.step), 1)
    return dict(zip(NAMES, [delay, *(round(value, 2) for value in values)], strict=True))
