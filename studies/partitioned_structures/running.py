"""Predictions of a partitioned test's error: laws, tracking over frequency, rebuilt error.

Tests are run in the digital laboratory: structures with different parts in the laboratory, with random servos
that are compensated well, too little or too much. Each prediction is held against the simulated error.
"""

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from reliab_studies.laboratory.compensators.model_inverse import ModelInverse
from reliab_studies.laboratory.laboratory import Rig, Run, Sensors, run_laboratory
from reliab_studies.rths_benchmark.benchmark import benchmark_partition

from reliab.assessment.rebuild import rebuild
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.shipped import shipped
from reliab.criterion.experimental_share import growth
from reliab.criterion.laws.dimensionless import Dimensionless
from reliab.criterion.laws.guo_2017 import Equation18
from reliab.motions.motion import Motion
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_file import governing_mode, place_of_governing_mode
from reliab.simulation.linear_loop.spectral import respond
from reliab.simulation.transfer_systems.transfer_function import TransferFunction
from reliab.structures.critical_delay import stability_limit
from reliab.structures.frame import (
    Frame,
    Specimen,
    add_specimen,
    drift_interface,
    floor_interface,
    modal_damping,
)
from reliab.structures.partition import Partition
from reliab.structures.planar_frame import shear_frame
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_dataset import open_ellipses
from reliab.tracking.indices.tracking import frequency_evaluation, tracking_over_frequency

RATE: Final = 4096.0
"""Sampling rate of the laboratory [Hz]."""


@dataclass(frozen=True, kw_only=True)
class PartitionedTest:
    """One test: structure, motion, and a servo with its compensation."""

    structure: str
    motion: Motion
    servo: TransferFunction
    inverse: tuple[float, ...]
    seed: int


def draw_tests(motions: Sequence[Motion], count: int, seed: int) -> list[PartitionedTest]:
    """Draw tests: structures and motions in turn, servos and compensations at random."""
    if not motions or count < 1:
        raise InputError("A study of partitioned tests needs motions and tests", value=f"{count} tests")
    generator = np.random.default_rng([seed, 18])
    names, tests = list(partitioned_structures()), []
    for number in range(count):
        frequency, damping = generator.uniform(12.0, 40.0), generator.uniform(0.5, 1.0)
        valve, gain = generator.uniform(60.0, 150.0), generator.normal(1.0, 0.01)
        delay, compensated = generator.uniform(0.0, 0.002), generator.uniform(0.85, 1.05)
        omega, pole = 2.0 * math.pi * frequency, 2.0 * math.pi * valve
        servo = TransferFunction.from_poles(
            [],
            [*np.roots([1.0, 2.0 * damping * omega, omega**2]), -pole],
            gain,
            static=True,
            delay=delay,
        )
        lag = 2.0 * damping / omega + 1.0 / pole + delay + 0.5 / RATE
        tests.append(
            PartitionedTest(
                structure=names[number % len(names)],
                motion=motions[number % len(motions)],
                servo=servo,
                inverse=(1.0, compensated * lag, 0.5 * (compensated * lag) ** 2),
                seed=1000 * seed + number,
            )
        )
    return tests


def partitioned_structures() -> dict[str, Partition]:
    """Structures of the study by name: springs, dampers and masses, at floors and in storeys."""
    structure = Structure(frequency=1.0, damping_ratio=0.03, experimental_fraction=0.5)
    mass, stiffness = shear_frame([2000.0, 2000.0, 1500.0], [1.2e6, 1.0e6, 8.0e5])
    frame = Frame(mass=mass, stiffness=stiffness, damping=modal_damping(mass, stiffness, 0.03))
    low, soft = shear_frame([3000.0, 2500.0], [4e5, 2.5e5])
    two = Frame(mass=low, stiffness=soft, damping=modal_damping(low, soft, 0.05))
    tall, tower = shear_frame([1500.0] * 6, [9e5] * 6)
    six = Frame(mass=tall, stiffness=tower, damping=modal_damping(tall, tower, 0.02))

    def spring(frame: Frame, interface: Array, specimen: Specimen) -> Partition:
        return Partition.from_frame(frame=frame, interface=interface, specimen=specimen)

    def beside(frame: Frame, interface: Array, specimen: Specimen) -> Partition:
        return spring(add_specimen(frame, interface, specimen), interface, specimen)

    return {
        "one mass, half of its spring": Partition.from_structure(structure, mass=1000.0),
        "two storeys, the first one tested": spring(
            two, floor_interface(two, 1), Specimen(stiffness=4e5, mass=100.0)
        ),
        "two storeys, the second one tested": spring(
            two, drift_interface(two, 2, 1), Specimen(stiffness=2.5e5)
        ),
        "three storeys, half of the first": spring(frame, floor_interface(frame, 1), Specimen(stiffness=6e5)),
        "three storeys, a heavy specimen": spring(
            frame, floor_interface(frame, 1), Specimen(stiffness=5e5, mass=300.0)
        ),
        "three storeys, a damper parallel to the first": beside(
            frame, floor_interface(frame, 1), Specimen(stiffness=2e4, damping=6e3, mass=20.0)
        ),
        "six storeys, the first one tested": spring(
            six, floor_interface(six, 1), Specimen(stiffness=9e5, mass=50.0)
        ),
        "benchmark, case 1": benchmark_partition(1),
        "benchmark, case 4": benchmark_partition(4),
    }


def shares_of_structures() -> pd.DataFrame:
    """Tabulate modes and the specimen's share in them.

    Columns `structure`, `mode`, `f` [Hz], `xi`, shares `alpha`, `mass` and `damping` [-], and
    `critical_delay_ms` of the structure.
    """
    rows = []
    for name, partition in partitioned_structures().items():
        limit = stability_limit(partition).delay
        ratios, alphas = partition.frame.damping_ratios, partition.stiffness_shares
        felt = partition.impedance_shares
        for mode, frequency in enumerate(partition.frame.modes.frequency):
            rows.append(
                {
                    "structure": name,
                    "mode": mode + 1,
                    "f": float(frequency),
                    "xi": float(ratios[mode]),
                    "alpha": float(alphas[mode]),
                    "mass": float(alphas[mode] - felt[mode].real),
                    "damping": float(felt[mode].imag / (2.0 * ratios[mode])),
                    "critical_delay_ms": 1e3 * limit,
                }
            )
    return pd.DataFrame(rows)


PREDICTIONS: Final = ("law_18", "law_with_share", "resolved", "rebuilt")
"""Columns of the predictions, from the coarsest to the finest."""

_THRESHOLD: Final = 0.05

_HIGHEST: Final = 2.0  # Hz, of the structures from which the law with the share is learned

_SPRING: Final = 0.9  # least part of the specimen's share that its spring has, so that it counts as one
_FORCE_LAG: Final = 1.5 / RATE

_THINNED: Final = 16

_DRAWS: Final = 16  # of the rebuilt error, whose value alone counts here


def mean_law() -> Dimensionless:
    """Dimensionless law through the geometric means of the ellipses that ship, at 5 % RMS^R."""
    ellipses = open_ellipses(shipped("datasets", "real_suite/ellipses.nc"))
    selected = ellipses.sel(threshold=_THRESHOLD, metric="rms", curve="ellipse")
    if "side" in selected.dims:
        selected = selected.sel(side="lag")
    order = ("motion", "f", "xi")
    a, b = (np.exp(np.log(selected[name].transpose(*order).values).mean(axis=0)) for name in ("a", "b"))
    return Dimensionless.fit(selected["f"].values, selected["xi"].values, a, b)


def _predict_by_index(a: float, b: float, amplitude: float, delay: float) -> float:
    """Error that an ellipse at 5 % gives to A [-] and d [ms], taking the error as proportional."""
    return _THRESHOLD * math.sqrt((amplitude - 1.0) ** 2 / a + delay**2 / b)


def predict_by_law_18(mode: Structure, amplitude: float, delay: float) -> float:
    """Predict RMS^R by equation (18).

    `amplitude`, `delay`: A [-] and d [ms]. Result: RMS^R [-]; NaN where the equation is not valid.
    """
    try:
        a, b = Equation18().limits(mode.frequency, mode.damping_ratio)
    except InputError:
        return math.nan
    return _predict_by_index(float(a), float(b), amplitude, delay)


def predict_by_law_with_share(
    law: Dimensionless, mode: Structure, partition: Partition, amplitude: float, delay: float
) -> float:
    """Predict RMS^R by the mean law and the growth of a and b with a smaller share α.

    `amplitude`, `delay`: A [-] and d [ms]. Result: RMS^R [-]; NaN where the specimen is no spring in that
    mode, or α too small beside ξ, so that the law of the share does not hold.
    """
    place = place_of_governing_mode(partition)
    if partition.stiffness_shares[place] < _SPRING * abs(partition.impedance_shares[place]):
        return math.nan
    try:
        factor = float(growth(mode.experimental_fraction, mode.damping_ratio))
    except InputError:
        return math.nan
    frequency = min(mode.frequency, _HIGHEST)
    a, b = law.limits(frequency, mode.damping_ratio)
    slower = (frequency / mode.frequency) ** 2
    return _predict_by_index(float(a) * factor, float(b) * slower * factor, amplitude, delay)


def resolved(run: Run, partition: Partition, motion: Motion) -> float:
    """Predict the RMS error from A and d over frequency, with the lag of the force.

    Gain and phase of the measured over the command displacement are estimated where the two are coherent, and
    kept beyond; the loop is then solved anew under the ground motion.

    RMS of the measured minus the exact displacement [m].
    """
    tracking = tracking_over_frequency(run.command, run.measured, run.step)

    load = (partition.mass @ partition.influence).astype(complex)[:, np.newaxis]

    def stray(s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        # The force is that of the measured displacement, late by the laboratory's own lag.
        tracked = tracking.transfer(s)
        late = tracked * np.exp(-s * _FORCE_LAG)
        ideal = np.linalg.solve(partition.frame.dynamic_stiffness(s), load)[..., 0] @ partition.direction
        command = ideal / (1.0 + partition.error_transfer(s)[..., 0, 0] * (late - 1.0))
        return np.asarray(tracked * command - ideal)

    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    strayed = respond(excitation, stray)[0]
    return float(np.sqrt(np.mean(strayed**2)))


def rebuilt(run: Run, partition: Partition) -> float:
    """Rebuild RMS^R [-] from the displacements of a test, at a sixteenth of its sampling rate."""
    thinned = slice(None, None, _THINNED)
    error = rebuild(
        run.command[thinned].copy(),
        run.measured[thinned].copy(),
        _THINNED * run.step,
        partition,
        feedback_lag=_FORCE_LAG,
        draws=_DRAWS,
    )
    return error.rms.value


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
        "law_18": predict_by_law_18(mode, *index),
        "law_with_share": predict_by_law_with_share(law, mode, partition, *index),
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
