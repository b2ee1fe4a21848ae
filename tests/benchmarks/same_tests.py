"""Errors of three runs of one test, judged together, beside the true ones.

    python tests/benchmarks/same_tests.py FOLDER --seed S --count N

Structures, specimens (linear, hardening, yielding) and actuators are those of
`tests/assessment/rebuilt_error/laboratory.py`, under the real records of FOLDER; the three runs have one
delay, twice and three times as much, 45 dB noise, and no recorded force. Frequency and damping ratio are
stated as laboratories know them: off by 2 and 15 % (one standard deviation). Printed: how near the errors of
the runs are to the true ones, how often the 90 % interval holds them, and the same where a run alone is
undecided.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from benchmark_script import argument_parser
from laboratory_tests import (
    LARGEST,
    SMALLEST,
    STEP,
    THRESHOLD,
    add_noise,
    draw_ground,
    draw_structure,
    misstate_structure,
    read_records,
)
from rebuilt_error import laboratory as lab

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.assessment.same_test import combine_runs
from reliab.assessment.verdict import word_of_probability
from reliab.core.errors import InputError
from reliab.criterion.derivation import published_criterion
from reliab.recordings.recording import Recording

SPECIMENS = (lab.LINEAR, lab.CUBIC, lab.HYSTERESIS)


def specimen_shape(specimen: int, peak: float, rng: np.random.Generator) -> tuple[float, float, float]:
    """Draw numbers of a specimen: hardening of 5 to 15 % at the peak, yielding at a ductility of 2 to 4."""
    if specimen == lab.CUBIC:
        return rng.uniform(0.05, 0.15) / peak**2, 0.0, 0.0
    if specimen == lab.HYSTERESIS:
        return peak / rng.uniform(2.0, 4.0), 0.03, 8.0
    return 0.0, 0.0, 0.0


def runs_of(seed: int, records: list[Path]) -> tuple[lab.Lab, list[lab.Outcome]]:
    """Draw a structure with its specimen, and three runs whose first one errs by 1 to 12 %."""
    rng = np.random.default_rng(seed)
    while True:
        ground = draw_ground(records, rng, longest=30.0)
        rig = draw_structure(rng)
        peak = float(np.abs(lab.run(rig, ground, ideal=ground).command).max())
        specimen = int(rng.choice(SPECIMENS))
        rig = replace(rig, specimen=specimen, shape=specimen_shape(specimen, peak, rng))
        ideal = lab.run(rig, ground, ideal=ground).command
        critical = 2.0 * rig.xi / (2.0 * math.pi * rig.f) / rig.alpha
        delay = critical * math.exp(rng.uniform(math.log(0.02), -1.5))
        rigs = (
            replace(rig, kind=lab.DELAY, numbers=(1.0, times * delay, 0.0, 0.0)) for times in (1.0, 2.0, 3.0)
        )
        outcomes = [lab.run(delayed, ground, ideal=ideal) for delayed in rigs]
        if SMALLEST < outcomes[0].rms < LARGEST and np.isfinite(outcomes[2].rms):
            return rig, [replace(run, measured=add_noise(run.measured, rng)) for run in outcomes]


def judge_runs(seed: int, records: list[Path]) -> Iterator[dict[str, float | str]]:
    """Judge three runs alone and together; nothing where they are refused."""
    rig, outcomes = runs_of(seed, records)
    structure = misstate_structure(rig, np.random.default_rng([seed, 1]))
    try:
        assessments = {
            f"run {place}": assess(
                Recording(command=outcome.command, measured=outcome.measured, time_step=STEP),
                structure,
                equipment=ordinary_equipment(),
                criterion=published_criterion("guo_2017_15"),
            )
            for place, outcome in enumerate(outcomes)
        }
        runs = combine_runs(assessments).runs
    except InputError as error:
        print(seed, error, flush=True)
        return
    for run, outcome, assessment in zip(runs, outcomes, assessments.values(), strict=True):
        yield {
            "seed": seed,
            "specimen": rig.specimen,
            "run": run.file,
            "true": outcome.rms,
            "ratio": run.error.value / outcome.rms,
            "ratio_alone": run.alone.value / outcome.rms,
            "held": run.error.low <= outcome.rms <= run.error.high,
            "held_alone": run.alone.low <= outcome.rms <= run.alone.high,
            "word": str(run.word),
            "word_alone": str(word_of_probability(assessment.error.probability)),
        }


def state(rows: pd.DataFrame, name: str) -> None:
    """Print a line about runs."""
    near, near_alone = ((rows[ratio] - 1.0).abs() < 0.2 for ratio in ("ratio", "ratio_alone"))
    bad = rows["true"] > THRESHOLD
    print(
        f"{name}: {len(rows)} runs, within 20 % {near.mean():.0%} (alone {near_alone.mean():.0%}), held "
        f"{rows['held'].mean():.0%} (alone {rows['held_alone'].mean():.0%}), undecided "
        f"{(rows['word'] == 'undecided').mean():.0%} "
        f"(alone {(rows['word_alone'] == 'undecided').mean():.0%}), "
        f"bad accepted {(bad & (rows['word'] == 'reliable')).sum()} of {bad.sum()}, good refused "
        f"{(~bad & (rows['word'] == 'not_reliable')).sum()} of {(~bad).sum()}"
    )


def main() -> None:
    options = argument_parser(__doc__, "folder", seed=int, count=40).parse_args()
    records = read_records(options.folder)
    rows = pd.DataFrame(
        row for seed in range(options.seed, options.seed + options.count) for row in judge_runs(seed, records)
    )
    state(rows, "all")
    for name, specimen in (("linear", lab.LINEAR), ("hardening", lab.CUBIC), ("yielding", lab.HYSTERESIS)):
        state(rows[rows["specimen"] == specimen], name)
    state(rows[rows["word_alone"] == "undecided"], "undecided alone")
    state(rows[rows["run"] == "run 0"], "smallest delay")


if __name__ == "__main__":
    main()
