"""Errors of three runs of one test, judged together, beside the true ones.

    python tests/benchmarks/same_tests.py FOLDER --seed S --count N

Structures, specimens (linear, hardening, yielding) and actuators are those of
`tests/assessment/rebuilt_error/laboratory.py`, under the real records of FOLDER; the three runs have one
delay, twice and three times as much, 45 dB noise, and no recorded force. Frequency and damping ratio are
stated as laboratories know them: off by 2 and 15 % (one standard deviation). Printed: how near the errors of
the runs are to the true ones, how often the 90 % interval holds them, and the same where a run alone is
undecided.
"""

import argparse
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import imperfect_recordings as single  # which puts the laboratory on the path
import numpy as np
import pandas as pd
from rebuilt_error import laboratory as lab

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.assessment.same_test import combine_runs
from reliab.assessment.verdict import word_of_probability
from reliab.core.errors import InputError
from reliab.criterion.published import published_criterion
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

SPECIMENS = (lab.LINEAR, lab.CUBIC, lab.HYSTERESIS)


def runs_of(seed: int, records: list[Path]) -> tuple[lab.Lab, list[lab.Outcome]]:
    """Draw a structure with its specimen, and three runs whose first one errs by 1 to 12 %."""
    rng = np.random.default_rng(seed)
    while True:
        ground = lab.read_at2(records[rng.integers(len(records))])[: int(rng.uniform(15.0, 30.0) * lab.RATE)]
        f, xi = math.exp(rng.uniform(math.log(0.4), math.log(2.5))), rng.uniform(0.02, 0.08)
        built = lab.Lab(f, xi, 1.0 if rng.uniform() < 0.5 else rng.uniform(0.3, 1.0), lab.DELAY)
        peak = float(np.abs(lab.run(replace(built, kind=lab.PERFECT), ground, ideal=ground).command).max())
        specimen = int(rng.choice(SPECIMENS))
        built = replace(built, specimen=specimen, shape=single.shape(specimen, peak, rng))
        ideal = lab.run(replace(built, kind=lab.PERFECT), ground, ideal=ground).command
        delay = 2.0 * xi / (2.0 * math.pi * f) / built.alpha * math.exp(rng.uniform(math.log(0.02), -1.5))
        outcomes = [
            lab.run(replace(built, numbers=(1.0, times * delay, 0.0, 0.0)), ground, ideal=ideal)
            for times in (1.0, 2.0, 3.0)
        ]
        if single.SMALLEST < outcomes[0].rms < single.LARGEST and np.isfinite(outcomes[2].rms):
            return built, [noisy(outcome, rng) for outcome in outcomes]


def noisy(outcome: lab.Outcome, rng: np.random.Generator) -> lab.Outcome:
    """Add the noise of the displacement sensor."""
    level = 10.0 ** (-single.DECIBELS / 20.0) * float(np.sqrt(np.mean(outcome.measured**2)))
    return replace(outcome, measured=outcome.measured + lab.noise("white", outcome.measured.size, level, rng))


def judged(seed: int, records: list[Path]) -> Iterator[dict[str, float | str]]:
    """Judge three runs alone and together; nothing where they are refused."""
    built, outcomes = runs_of(seed, records)
    rng = np.random.default_rng([seed, 1])
    structure = Structure(
        frequency=built.f * (1.0 + 0.02 * rng.standard_normal()),
        damping_ratio=built.xi * max(1.0 + 0.15 * rng.standard_normal(), 0.4),
        experimental_fraction=built.alpha,
    )
    try:
        alone = {
            f"run {place}": assess(
                Recording(command=one.command, measured=one.measured, time_step=single.STEP),
                structure,
                equipment=ordinary_equipment(),
                criterion=published_criterion("guo_2017_15"),
            )
            for place, one in enumerate(outcomes)
        }
        together = combine_runs(alone).runs
    except InputError as error:
        print(seed, error, flush=True)
        return
    for run, outcome, found in zip(together, outcomes, alone.values(), strict=True):
        yield {
            "seed": seed,
            "specimen": built.specimen,
            "run": run.file,
            "true": outcome.rms,
            "ratio": run.error.value / outcome.rms,
            "ratio_alone": run.alone.value / outcome.rms,
            "held": run.error.low <= outcome.rms <= run.error.high,
            "held_alone": run.alone.low <= outcome.rms <= run.alone.high,
            "word": str(run.word),
            "word_alone": str(word_of_probability(found.error.probability)),
        }


def state(rows: pd.DataFrame, name: str) -> None:
    """Print a line about runs."""
    near, alone = ((rows[ratio] - 1.0).abs() < 0.2 for ratio in ("ratio", "ratio_alone"))
    bad = rows["true"] > single.THRESHOLD
    print(
        f"{name}: {len(rows)} runs, within 20 % {near.mean():.0%} (alone {alone.mean():.0%}), held "
        f"{rows['held'].mean():.0%} (alone {rows['held_alone'].mean():.0%}), undecided "
        f"{(rows['word'] == 'undecided').mean():.0%} "
        f"(alone {(rows['word_alone'] == 'undecided').mean():.0%}), "
        f"bad accepted {(bad & (rows['word'] == 'reliable')).sum()} of {bad.sum()}, good refused "
        f"{(~bad & (rows['word'] == 'not_reliable')).sum()} of {(~bad).sum()}"
    )


def main() -> None:
    """Judge tests and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=40)
    asked = parser.parse_args()
    records = single.read_records(asked.folder)
    rows = pd.DataFrame(
        row for seed in range(asked.seed, asked.seed + asked.count) for row in judged(seed, records)
    )
    state(rows, "all")
    for name, specimen in (("linear", lab.LINEAR), ("hardening", lab.CUBIC), ("yielding", lab.HYSTERESIS)):
        state(rows[rows["specimen"] == specimen], name)
    state(rows[rows["word_alone"] == "undecided"], "undecided alone")
    state(rows[rows["run"] == "run 0"], "smallest delay")


if __name__ == "__main__":
    main()
