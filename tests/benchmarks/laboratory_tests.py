"""Tests that `tests/assessment/rebuilt_error/laboratory.py` simulates, drawn at random under real records."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import paths  # noqa: F401 - makes the laboratory importable
from rebuilt_error import laboratory as lab

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.error_of_test import Question
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.core.vocabulary import Metric
from reliab.structures.structure import Structure

STEP, THRESHOLD, DECIBELS = 1.0 / lab.RATE, 0.05, 45.0
SMALLEST, LARGEST = 0.01, 0.12  # of true errors


def read_records(folder: Path) -> list[Path]:
    """Files of a catalogue."""
    return [folder / name for name in pd.read_csv(folder / "catalog.csv")["file"]]


def draw_ground(records: Sequence[Path], rng: np.random.Generator, longest: float = 40.0) -> np.ndarray:
    """Draw one record and cut it to 15 s or more."""
    ground = lab.read_at2(records[rng.integers(len(records))])
    return ground[: int(rng.uniform(15.0, longest) * lab.RATE)]


def draw_structure(rng: np.random.Generator) -> lab.Lab:
    """Draw f, ξ and α of a structure with a perfect actuator."""
    f, xi = math.exp(rng.uniform(math.log(0.4), math.log(2.5))), rng.uniform(0.02, 0.08)
    return lab.Lab(f, xi, 1.0 if rng.uniform() < 0.5 else rng.uniform(0.3, 1.0))


def draw_test(
    records: Sequence[Path],
    rng: np.random.Generator,
    limits: tuple[float, float],
    actuators: Sequence[int],
) -> tuple[lab.Lab, lab.Outcome]:
    """Draw a test whose RMS^R lies between the limits."""
    while True:
        ground = draw_ground(records, rng)
        rig = draw_structure(rng)
        ideal = lab.run(rig, ground, ideal=ground).command
        peak = float(np.abs(ideal).max())
        if not peak > 0.0:
            continue
        rig = replace(rig, kind=int(rng.choice(actuators)))
        rig = replace(rig, numbers=actuator_numbers(rig, peak, rng))
        outcome = lab.run(rig, ground, ideal=ideal)
        if np.isfinite(outcome.rms) and limits[0] < outcome.rms < limits[1]:
            return rig, outcome


def actuator_numbers(
    rig: lab.Lab, peak: float, rng: np.random.Generator
) -> tuple[float, float, float, float]:
    """Numbers of an actuator that errs by some per cent."""
    w0 = 2.0 * math.pi * rig.f
    tau = 2.0 * rig.xi / w0 / rig.alpha * math.exp(rng.uniform(math.log(0.02), math.log(0.4)))
    gain = 1.0 + 0.3 * rig.xi * rng.normal()
    return {
        lab.DELAY: (gain, tau, 0.01 * tau * rng.uniform(-1.0, 1.0), 0.0),
        lab.LAG: (gain, tau, 0.0, 0.0),
        lab.RATE_LIMIT: (gain, tau, peak * w0 * rng.uniform(0.4, 1.0), 0.0),
        lab.BACKLASH: (peak * rig.xi * rng.uniform(0.02, 0.3), 0.0, 0.0, 0.0),
        lab.LEAD: (gain, tau, 0.0, 0.0),
        lab.SECOND_ORDER: (gain, 1.4 / tau, 0.7, 0.0),
    }[rig.kind]


def noise_level(values: np.ndarray, decibels: float = DECIBELS) -> float:
    """Standard deviation of noise so many decibels below the RMS of values."""
    return 10.0 ** (-decibels / 20.0) * float(np.sqrt(np.mean(values**2)))


def add_noise(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Add the white noise of a displacement sensor."""
    return values + lab.noise("white", values.size, noise_level(values), rng)


def later(values: np.ndarray, seconds: float) -> np.ndarray:
    """A history later by a time, at rest before and after it; exact below the Nyquist frequency."""
    pad = 4096
    history = np.concatenate([np.full(pad, values[0]), values, np.full(pad, values[-1])])
    level = np.linspace(history[0], history[-1], history.size)
    shift = np.exp(-2j * np.pi * np.fft.rfftfreq(history.size, STEP) * seconds)
    moved = np.fft.irfft(np.fft.rfft(history - level) * shift, history.size) + level
    return moved[pad : pad + values.size]


def question(structure: Structure, equipment: Equipment) -> Question:
    """What is asked of a test of which nothing else is stated."""
    return Question(
        structure=structure,
        stated={},
        equipment=equipment,
        metric=Metric.RMS,
        threshold=THRESHOLD,
        model=None,
        seed=0,
    )


def misstate_structure(rig: lab.Lab, rng: np.random.Generator) -> Structure:
    """State f and ξ as laboratories know them: off by 2 and 15 %, one standard deviation."""
    return Structure(
        frequency=rig.f * (1.0 + 0.02 * rng.standard_normal()),
        damping_ratio=rig.xi * max(1.0 + 0.15 * rng.standard_normal(), 0.4),
        experimental_fraction=rig.alpha,
    )


def score_verdict(rms: Estimate, true: float, word: str) -> dict[str, float | bool]:
    """Compare a stated error and a verdict with the true error."""
    return {
        "true": true,
        "ratio": rms.value / true,
        "width": (rms.high - rms.low) / true,
        "held": rms.low <= true <= rms.high,
        "bad_accepted": true > THRESHOLD and word == "reliable",
        "good_refused": true < THRESHOLD and word == "not_reliable",
        "undecided": word == "undecided",
    }
