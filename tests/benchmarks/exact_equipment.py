"""Measure what verdicts are worth where channels and structure are as stated.

`python tests/benchmarks/exact_equipment.py RECORDS --seed S --count N` draws N tests with true errors of 1 to
12 % (`laboratory_tests.py`), with white noise 45 dB below the motion, and asks for their errors with nothing
stated but f, ξ and α, all exact. Printed are the ratios of stated to true RMS^R, how often the 90 % interval
holds the truth (with its Wilson interval), verdicts at 5 %, and the share of good tests called reliable by
size of the true error.
"""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import paths  # noqa: F401 - makes the laboratory importable
from benchmark_script import argument_parser
from blind_campaigns.scoring import wilson_interval
from laboratory_tests import (
    LARGEST,
    SMALLEST,
    STEP,
    add_noise,
    draw_test,
    question,
    read_records,
    score_verdict,
)
from rebuilt_error import laboratory as lab

from reliab.assessment.budget.sizes import exact_equipment
from reliab.assessment.error_of_test import error_of_test
from reliab.assessment.verdict import word_of_probability
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

ACTUATORS = (lab.DELAY, lab.DELAY, lab.LAG, lab.SECOND_ORDER, lab.RATE_LIMIT, lab.LEAD, lab.BACKLASH)


def judge_draw(seed: int, records: list[Path]) -> dict[str, float | bool]:
    """Draw a test and compare what is stated of it with the truth."""
    rng = np.random.default_rng([seed, lab.LINEAR])
    rig, outcome = draw_test(records, rng, (SMALLEST, LARGEST), ACTUATORS)
    recording = Recording(command=outcome.command, measured=add_noise(outcome.measured, rng), time_step=STEP)
    structure = Structure(frequency=rig.f, damping_ratio=rig.xi, experimental_fraction=rig.alpha)
    error = error_of_test(recording, question(structure, exact_equipment()))
    return score_verdict(error.rebuilt.rms, outcome.rms, str(word_of_probability(error.probability)))


def main() -> None:
    options = argument_parser(__doc__, "folder", seed=int, count=120).parse_args()
    records = read_records(options.folder)
    rows = pd.DataFrame(judge_draw(options.seed + number, records) for number in range(options.count))
    print(rows["ratio"].quantile([0.05, 0.95]).round(3).tolist(), "stated over true, 5 to 95 %")
    low, high = wilson_interval(int(rows["held"].sum()), len(rows))
    print(f"held {rows['held'].mean():.0%} ({low:.0%} to {high:.0%}), width {rows['width'].median():.2f}")
    print(rows[["bad_accepted", "good_refused", "undecided"]].sum().to_dict())
    words = rows["bad_accepted"] | ~(rows["good_refused"] | rows["undecided"])
    for least in (0.01, 0.02, 0.03, 0.04):
        band = rows[(rows["true"] >= least) & (rows["true"] < least + 0.01)]
        reliable = words[band.index].mean() if len(band) else math.nan
        print(f"true error {least:.0%} to {least + 0.01:.0%}: {reliable:.0%} of {len(band)} reliable")


if __name__ == "__main__":
    main()
