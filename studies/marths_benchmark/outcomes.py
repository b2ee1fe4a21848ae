"""The multi-axial benchmark run through: criteria J1 to J10, and the error of each test, true and rebuilt."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

import numpy as np

from reliab.arrays import Array
from reliab.motions import Motion
from reliab.progress import Progress, silent

from .controllers import PERFECT, find_controller
from .criteria import NAMES, criteria
from .loop import MultiAxialRun, reference, run_perfect, run_test
from .plant import NOMINAL, CoupledPlant, drawn_plants, nominal_plant
from .rebuilding import rebuilt_error
from .structure import RATE, SCALE, to_node

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


def scaled_record(motion: Motion) -> Array:
    """Ground acceleration of the benchmark at 1024 Hz [m/s²], linear between the samples of the record."""
    recorded = motion.time_step * np.arange(motion.acceleration.size)
    times = np.arange(int(recorded[-1] * RATE + 1e-9) + 1) / RATE
    return np.asarray(SCALE * np.interp(times, recorded, motion.acceleration))


def run_benchmark(
    motions: Sequence[Motion], request: MultiAxialRequest, *, progress: Progress = silent
) -> list[dict[str, Any]]:
    """Run all tests; perfect actuators come first under each motion."""
    grounds = [(motion.name, scaled_record(motion)) for motion in motions]
    ideal = {name: (run_perfect(ground), reference(ground)) for name, ground in grounds}
    rows = [_row(name, PERFECT, NOMINAL, *ideal[name]) for name, _ in grounds]
    cases = list(_cases(grounds, request))
    with ThreadPoolExecutor(_WORKERS) as workers:
        judged = workers.map(partial(_judged, ideal=ideal), cases)
        for done, row in enumerate(judged, start=1):
            rows.append(row)
            progress(done, len(cases))
    return rows


_Case = tuple[str, Array, CoupledPlant, str, int]


def _cases(grounds: Sequence[tuple[str, Array]], request: MultiAxialRequest) -> Iterator[_Case]:
    uncertain = drawn_plants(request.perturbed, request.seed)
    for name in request.controllers:
        for motion, ground in grounds:
            yield motion, ground, nominal_plant(), name, request.seed
        for number, plant in enumerate(uncertain):
            yield *grounds[number % len(grounds)], plant, name, request.seed + 1 + number


def _judged(case: _Case, *, ideal: dict[str, tuple[MultiAxialRun, Array]]) -> dict[str, Any]:
    motion, ground, plant, name, seed = case
    run = run_test(ground, plant, find_controller(name), seed=seed)
    perfect, undivided = ideal[motion]
    largest = np.abs(perfect.target).max(axis=1, keepdims=True)
    if not (np.abs(run.measured) < _LARGEST * largest).all():
        return _lost(motion, name, plant.name)
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


def _lost(motion: str, name: str, plant: str) -> dict[str, Any]:
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
