"""The multi-axial benchmark run through: criteria J1 to J10, and the error of each test, true and rebuilt.

The computer integrates by Newmark's method and differentiates what it measures backwards, which the rebuilt
error does not know.
"""

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

import numpy as np
import scipy

from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.assessment.inference.uncertain_quantity import EXACTLY_KNOWN, PriorKnowledge
from reliab.assessment.rebuild import RebuiltError, rebuild
from reliab.core.arrays import Array
from reliab.core.progress import Progress, silent
from reliab.motions.motion import Motion

from .controllers import PERFECT, find_controller
from .loop import MultiAxialRun, reference, run_perfect, run_test
from .plant import NOMINAL, CoupledPlant, draw_plants, nominal_plant
from .structure import RATE, SCALE, benchmark_partition, to_node

DEGREES: Final = ("x", "theta")

_DRAWS, _FEW_DRAWS = 64, 16  # of the error of a test with the nominal plant, and with another
_LARGEST: Final = 10.0  # times the reference: a test that moves further is lost
_WORKERS: Final = 2


@dataclass(frozen=True, kw_only=True)
class MultiAxialRequest:
    """What is run: controllers, and uncertain plants, each of which meets one of the motions in turn."""

    controllers: tuple[str, ...]
    perturbed: int
    seed: int


def scale_record(motion: Motion) -> Array:
    """Ground acceleration of the benchmark at 1024 Hz [m/s²], linear between the samples of the record."""
    recorded = motion.time_step * np.arange(motion.acceleration.size)
    times = np.arange(int(recorded[-1] * RATE + 1e-9) + 1) / RATE
    return np.asarray(SCALE * np.interp(times, recorded, motion.acceleration))


def run_benchmark(
    motions: Sequence[Motion], request: MultiAxialRequest, *, progress: Progress = silent
) -> list[dict[str, Any]]:
    """Run all tests; perfect actuators come first under each motion."""
    grounds = [(motion.name, scale_record(motion)) for motion in motions]
    ideal = {name: (run_perfect(ground), reference(ground)) for name, ground in grounds}
    rows = [_row(name, PERFECT, NOMINAL, *ideal[name]) for name, _ in grounds]
    cases = list(_cases(grounds, request))
    with ThreadPoolExecutor(_WORKERS) as workers:
        judged = workers.map(partial(_judge_case, ideal=ideal), cases)
        for done, row in enumerate(judged, start=1):
            rows.append(row)
            progress(done, len(cases))
    return rows


_Case = tuple[str, Array, CoupledPlant, str, int]


def _cases(grounds: Sequence[tuple[str, Array]], request: MultiAxialRequest) -> Iterator[_Case]:
    uncertain = draw_plants(request.perturbed, request.seed)
    for name in request.controllers:
        for motion, ground in grounds:
            yield motion, ground, nominal_plant(), name, request.seed
        for number, plant in enumerate(uncertain):
            yield *grounds[number % len(grounds)], plant, name, request.seed + 1 + number


def _judge_case(case: _Case, *, ideal: dict[str, tuple[MultiAxialRun, Array]]) -> dict[str, Any]:
    motion, ground, plant, name, seed = case
    run = run_test(ground, plant, find_controller(name), seed=seed)
    perfect, undivided = ideal[motion]
    largest = np.abs(perfect.target).max(axis=1, keepdims=True)
    if not (np.abs(run.measured) < _LARGEST * largest).all():
        return _row_of_lost_test(motion, name, plant.name)
    row = _row(motion, name, plant.name, run, undivided)
    if plant.name != NOMINAL:
        return {**row, "error": _errors(run, perfect, _FEW_DRAWS)}
    ordinary = rebuilt_error(run.target, run.measured, _DRAWS, ordinary=True)
    errors = _errors(run, perfect, _DRAWS)
    for name, degree in zip(DEGREES, ordinary.displacements, strict=True):
        errors[name] |= {"ordinary_low": degree.rms.low, "ordinary_high": degree.rms.high}
    return {**row, "error": errors}


def _row(motion: str, name: str, plant: str, run: MultiAxialRun, undivided: Array) -> dict[str, Any]:
    none = {"true": 0.0, "value": None, "low": None, "high": None}
    return {
        "motion": motion,
        "controller": name,
        "plant": plant,
        "lost": False,
        **criteria(run, undivided),
        "error": {degree: dict(none) for degree in DEGREES},
    }


def _row_of_lost_test(motion: str, name: str, plant: str) -> dict[str, Any]:
    none = dict.fromkeys(("true", "value", "low", "high"))
    return {
        "motion": motion,
        "controller": name,
        "plant": plant,
        "lost": True,
        **dict.fromkeys(NAMES),
        "error": {degree: dict(none) for degree in DEGREES},
    }


def _errors(run: MultiAxialRun, perfect: MultiAxialRun, draws: int) -> dict[str, dict[str, float]]:
    """RMS^R of x and θ against perfect actuators, and as the test's own displacements give it."""
    ideal = to_node(perfect.target)
    strayed = to_node(run.true) - ideal
    true = np.sqrt(np.mean(strayed**2, axis=1)) / np.abs(ideal).max(axis=1)
    rebuilt = rebuilt_error(run.target, run.measured, draws)
    return {
        name: {
            "true": float(value),
            "value": degree.rms.value,
            "low": degree.rms.low,
            "high": degree.rms.high,
        }
        for name, value, degree in zip(DEGREES, true, rebuilt.displacements, strict=True)
    }


NAMES: Final = tuple(f"J{number}" for number in range(1, 11))


def tracking_delay(target: Array, measured: Array) -> float:
    """Lag [ms] at which the two histories correlate best, negative where the measured one leads.

    >>> target = np.sin(0.01 * np.arange(3000)) * np.exp(-((np.arange(3000) - 1500.0) / 400.0) ** 2)
    >>> round(tracking_delay(target[5:], target[:-5]) * RATE / 1e3, 6)
    5.0
    """
    correlation = np.abs(scipy.signal.correlate(measured, target, method="fft"))
    return float(np.argmax(correlation) - (target.size - 1)) / RATE * 1e3


def spread(difference: Array, base: Array) -> float:
    """Return the standard deviation of a difference over that of its base [%]."""
    return 100.0 * float(np.std(difference, ddof=1) / np.std(base, ddof=1))


def peak(difference: Array, base: Array) -> float:
    """Largest difference over the largest value of its base [%]."""
    return 100.0 * float(np.abs(difference).max() / np.abs(base).max())


def criteria(run: MultiAxialRun, reference: Array) -> dict[str, Any]:
    """J1 [ms] and J2 to J10 [%] of a test; `reference` as `loop.reference` gives it.

    J1 to J3 by actuator, J5 to J7 and J9 for x and θ of the node, J8 and J10 for x and θ of storeys 2 and 3.
    J4 is J1, as the benchmark's code has it.
    """
    error = run.measured - run.target
    node = to_node(run.measured)
    node[1] *= -1.0
    numerical, undivided = run.numerical[[0, 3]], reference[[0, 3]]
    above = [1, 4, 2, 5]
    delays = [tracking_delay(*pair) for pair in zip(run.target, run.measured, strict=True)]
    strayed = run.numerical[above] - reference[above]
    return {
        "J1": delays,
        "J2": _measure_each(spread, error, run.target),
        "J3": _measure_each(peak, error, run.target),
        "J4": delays,
        "J5": _measure_each(spread, node - numerical, numerical),
        "J6": _measure_each(peak, node - numerical, numerical),
        "J7": _measure_each(spread, node - undivided, undivided),
        "J8": _measure_each(spread, strayed, reference[above]),
        "J9": _measure_each(peak, node - undivided, undivided),
        "J10": _measure_each(peak, strayed, reference[above]),
    }


def _measure_each(measure: Any, differences: Array, bases: Array) -> list[float]:  # noqa: ANN401
    return [measure(difference, base) for difference, base in zip(differences, bases, strict=True)]


def rebuilt_error(target: Array, measured: Array, draws: int, *, ordinary: bool = False) -> RebuiltError:
    """Rebuild the error of x and θ from displacements of the actuators [mm], shape (2, n).

    Everything but the noise is exact, as in the simulation, or as `ordinary` equipment leaves it.
    """
    return rebuild(
        to_node(target),
        to_node(measured),
        1.0 / RATE,
        benchmark_partition(),
        sensor_offset=None if ordinary else np.zeros(2),
        known=PriorKnowledge(equipment=ordinary_equipment()) if ordinary else EXACTLY_KNOWN,
        draws=draws,
    )
