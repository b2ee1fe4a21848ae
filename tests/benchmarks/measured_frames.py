"""Errors of frames' tests whose specimen is known by its force only, beside the true ones.

python tests/benchmarks/measured_frames.py RECORDS --seed 371127 --count 5
"""

import numpy as np
import pandas as pd
import paths  # noqa: F401 - makes the frames importable
from benchmark_script import argument_parser
from nonlinear_frames import FAMILIES, STEP, FrameTest, simulate_frame_test

from reliab.assessment.assess import assess
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion

_FAMILIES = (
    *("linear", "bilinear", "cubic", "gap", "Bouc-Wen", "degrading", "Baber-Noori"),
    *("Menegotto-Pinto", "peak-oriented", "LuGre friction", "Ramberg-Osgood"),
)
_GOOD = 0.05


def draw_test(family: str, motions: list[Motion], draw: np.random.Generator, decibels: float) -> FrameTest:
    """Simulate a test whose error is neither tiny nor of a loop that diverges."""
    times = np.arange(0.0, 40.0, STEP)
    while True:
        motion = motions[int(draw.integers(len(motions)))]
        ends = motion.time_step * motion.acceleration.size
        instants = np.arange(motion.acceleration.size) * motion.time_step
        ground = np.interp(times, instants, motion.acceleration) * (times <= ends)
        test = simulate_frame_test(family, ground, draw, decibels=decibels)
        if np.isfinite(test.moved).all() and 0.003 < test.error < 0.3:
            return test


def judge_test(family: str, test: FrameTest) -> dict[str, object]:
    """Judge a test by its force, and that of a linear specimen as it is stated, too."""
    assessment = assess(test.recording, test.frame, measured_specimen=True)
    rebuilt, original = assessment.error.rebuilt, test.moved - test.exact
    displacement = rebuilt.displacements[0]
    row = {
        "family": family,
        "true": test.error,
        "value": rebuilt.rms.value,
        "low": rebuilt.rms.low,
        "high": rebuilt.rms.high,
        "word": str(assessment.verdict),
        "inside": np.mean((displacement.low <= original) & (original <= displacement.high)),
        "left": np.sqrt(np.mean((displacement.reference - test.exact) ** 2) / np.mean(original**2)),
    }
    if family == "linear":
        stated_error = assess(test.recording, test.frame, linear_specimen=True).error.rebuilt.rms
        row["width"] = (rebuilt.rms.high - rebuilt.rms.low) / (stated_error.high - stated_error.low)
    return row


def main() -> None:
    options = argument_parser(__doc__, "records", seed=1, count=1).parse_args()
    motions, rows = list(load_motions(options.records)), []
    for number in range(options.count):
        for family in _FAMILIES:
            draw = np.random.default_rng([options.seed, list(FAMILIES).index(family), number])
            rows.append(judge_test(family, draw_test(family, motions, draw, (40.0, 30.0)[number % 2])))
    tests = pd.DataFrame(rows)
    away, good = (tests["value"] / tests["true"] - 1.0).abs(), tests["true"] <= _GOOD
    tests = tests.assign(
        near=away < 0.1,
        wide=away < 0.25,
        held=(tests["low"] <= tests["true"]) & (tests["true"] <= tests["high"]),
        accepted=(tests["word"] == "reliable").where(good),
        false_safe=(tests["word"] == "reliable") & ~good,
    )
    rates = ["near", "wide", "held", "inside", "accepted", "false_safe", "width"]
    print(tests.groupby("family", sort=False)[rates].mean().round(2).to_string())
    print(tests[rates].mean().round(3).to_string(), f"\nleft, median {tests['left'].median():.3f}")


if __name__ == "__main__":
    main()
