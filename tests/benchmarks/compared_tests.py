"""Order of two tests of one structure and rig, as `compare` states it, beside the true one.

    python tests/benchmarks/compared_tests.py FOLDER --seed S --count N --rate 256

Structures and actuators are those of `tests/assessment/rebuilt_error/laboratory.py`, under the real records
of FOLDER. The two tests have one motion and delays of their own; frequency, damping ratio, scale of sensors
and skew (up to a sample either way) are not as stated, by as much in both, or with `--apart` the skew of each
by itself, which is not what `compare` assumes. Noise is 45 dB, no force is recorded. Printed: how often the
test with the smaller error stands first, how often its probability is 95 % or more and how often it then is
right, and the same by classes of that probability.
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from benchmark_script import argument_parser
from laboratory_tests import (
    LARGEST,
    SMALLEST,
    add_noise,
    draw_ground,
    draw_structure,
    later,
    misstate_structure,
    question,
    read_records,
)
from rebuilt_error import laboratory as lab

from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.assessment.comparison import subtract_errors
from reliab.assessment.error_of_test import error_of_test
from reliab.core.vocabulary import Metric
from reliab.recordings.recording import Recording

CLASSES = (0.0, 0.6, 0.8, 0.95, 1.0)
LONGEST = 0.012  # s


def draw_pair(seed: int, records: list[Path]) -> tuple[lab.Lab, list[lab.Outcome], np.random.Generator]:
    """Draw a structure, and two tests with errors of 1 to 12 %."""
    rng = np.random.default_rng(seed)
    while True:
        ground = draw_ground(records, rng, longest=30.0)
        rig = draw_structure(rng)
        ideal = lab.run(rig, ground, ideal=ground).command
        delays = (LONGEST * rng.uniform(size=2)).tolist()
        rigs = (replace(rig, kind=lab.DELAY, numbers=(1.0, delay, 0.0, 0.0)) for delay in delays)
        outcomes = [lab.run(delayed, ground, ideal=ideal) for delayed in rigs]
        if all(SMALLEST < outcome.rms < LARGEST for outcome in outcomes):
            return rig, outcomes, rng


def compare_pair(seed: int, records: list[Path], rate: float, *, independent_skews: bool) -> dict[str, float]:
    """Judge two tests and compare them."""
    rig, outcomes, rng = draw_pair(seed, records)
    structure = misstate_structure(rig, rng)
    scale = 1.0 + 0.006 * rng.standard_normal()
    skews = (rng.uniform(size=2) - rng.uniform(size=2)) / rate
    errors = []
    for outcome, skew in zip(outcomes, skews if independent_skews else [skews[0]] * 2, strict=True):
        read = add_noise(scale * later(outcome.measured, skew), rng)
        thinning = slice(None, None, round(lab.RATE / rate))
        recording = Recording(
            command=outcome.command[thinning], measured=read[thinning], time_step=1.0 / rate
        )
        errors.append(error_of_test(recording, question(structure, ordinary_equipment())))
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
    options = argument_parser(__doc__, "folder", seed=int, count=40, rate=lab.RATE, apart=False).parse_args()
    records = read_records(options.folder)
    seeds = range(options.seed, options.seed + options.count)
    pairs = pd.DataFrame(
        compare_pair(seed, records, options.rate, independent_skews=options.apart) for seed in seeds
    )
    sure = pairs[pairs["probability"] >= CLASSES[-2]]
    print(
        f"{len(pairs)} pairs at {options.rate:g} Hz: order right {pairs['right'].mean():.0%}, stated as 95 % "
        f"or more {len(sure)}, of which right {sure['right'].sum()}; Brier "
        f"{((pairs['probability'] - pairs['right']) ** 2).mean():.3f}"
    )
    for (_, group), low, high in zip(
        pairs.groupby(pd.cut(pairs["probability"], CLASSES, include_lowest=True), observed=False),
        CLASSES[:-1],
        CLASSES[1:],
        strict=True,
    ):
        print(f"{low:.0%} to {high:.0%} stated: right {group['right'].sum()} of {len(group)}")


if __name__ == "__main__":
    main()
