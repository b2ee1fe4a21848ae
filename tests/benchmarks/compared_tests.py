"""Order of two tests of one structure and rig, as `compare` states it, beside the true one.

    python tests/benchmarks/compared_tests.py FOLDER --seed S --count N --rate 256

Structures and actuators are those of `tests/assessment/rebuilt_error/laboratory.py`, under the real records
of FOLDER. The two tests have one motion and delays of their own; frequency, damping ratio, scale of sensors
and skew (up to a sample either way) are not as stated, by as much in both, or with `--apart` the skew of each
by itself, which is not what `compare` assumes. Noise is 45 dB, no force is recorded. Printed: how often the
test with the smaller error stands first, how often its probability is 95 % or more and how often it then is
right, and the same by classes of that probability.
"""

import argparse
import math
from dataclasses import replace
from pathlib import Path

import imperfect_recordings as single  # which puts the laboratory on the path
import numpy as np
import pandas as pd
from rebuilt_error import laboratory as lab

from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.assessment.comparison import subtract_errors
from reliab.assessment.error_of_test import error_of_test
from reliab.core.vocabulary import Metric
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

CLASSES = (0.0, 0.6, 0.8, 0.95, 1.0)
LONGEST = 0.012  # s


def drawn(seed: int, records: list[Path]) -> tuple[lab.Lab, list[lab.Outcome], np.random.Generator]:
    """Draw a structure, and two tests with errors of 1 to 12 %."""
    rng = np.random.default_rng(seed)
    while True:
        ground = lab.read_at2(records[rng.integers(len(records))])[: int(rng.uniform(15.0, 30.0) * lab.RATE)]
        f, xi = math.exp(rng.uniform(math.log(0.4), math.log(2.5))), rng.uniform(0.02, 0.08)
        built = lab.Lab(f, xi, 1.0 if rng.uniform() < 0.5 else rng.uniform(0.3, 1.0), lab.DELAY)
        ideal = lab.run(replace(built, kind=lab.PERFECT), ground, ideal=ground).command
        delays = LONGEST * rng.uniform(size=2)
        outcomes = [
            lab.run(replace(built, numbers=(1.0, float(delay), 0.0, 0.0)), ground, ideal=ideal)
            for delay in delays
        ]
        if all(np.isfinite(one.rms) and single.SMALLEST < one.rms < single.LARGEST for one in outcomes):
            return built, outcomes, rng


def compared(seed: int, records: list[Path], rate: float, *, apart: bool) -> dict[str, float]:
    """Judge two tests and compare them."""
    built, outcomes, rng = drawn(seed, records)
    structure = Structure(
        frequency=built.f * (1.0 + 0.02 * rng.standard_normal()),
        damping_ratio=built.xi * max(1.0 + 0.15 * rng.standard_normal(), 0.4),
        experimental_fraction=built.alpha,
    )
    scale = 1.0 + 0.006 * rng.standard_normal()
    skews = (rng.uniform(size=2) - rng.uniform(size=2)) / rate
    errors = []
    for outcome, skew in zip(outcomes, skews if apart else [skews[0]] * 2, strict=True):
        read = scale * single.later(outcome.measured, skew)
        level = 10.0 ** (-single.DECIBELS / 20.0) * float(np.sqrt(np.mean(read**2)))
        read = read + lab.noise("white", read.size, level, rng)
        every = slice(None, None, round(lab.RATE / rate))
        recording = Recording(command=outcome.command[every], measured=read[every], time_step=1.0 / rate)
        errors.append(error_of_test(recording, single.question(structure, ordinary_equipment())))
    first, second = np.argsort([error.estimate(Metric.RMS).value for error in errors])
    differences, weights = subtract_errors(errors[second], errors[first], Metric.RMS)
    true = [outcome.rms for outcome in outcomes]
    return {
        "seed": seed,
        "apart": abs(math.log(true[0] / true[1])),
        "probability": float(np.average(differences > 0.0, weights=weights)),
        "right": bool(true[first] < true[second]),
    }


def main() -> None:
    """Compare pairs of tests and print what was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--rate", type=float, default=lab.RATE)
    parser.add_argument("--apart", action="store_true")
    asked = parser.parse_args()
    records = single.read_records(asked.folder)
    seeds = range(asked.seed, asked.seed + asked.count)
    pairs = pd.DataFrame(compared(seed, records, asked.rate, apart=asked.spread_factor) for seed in seeds)
    sure = pairs[pairs["probability"] >= CLASSES[-2]]
    print(
        f"{len(pairs)} pairs at {asked.rate:g} Hz: order right {pairs['right'].mean():.0%}, stated as 95 % "
        f"or more {len(sure)}, of which right {sure['right'].sum()}; Brier "
        f"{((pairs['probability'] - pairs['right']) ** 2).mean():.3f}"
    )
    for (_, of), low, high in zip(
        pairs.groupby(pd.cut(pairs["probability"], CLASSES, include_lowest=True), observed=False),
        CLASSES[:-1],
        CLASSES[1:],
        strict=True,
    ):
        print(f"{low:.0%} to {high:.0%} stated: right {of['right'].sum()} of {len(of)}")


if __name__ == "__main__":
    main()
