"""Errors of tests whose specimen is known by its force only, beside the true ones, family by family.

    python tests/benchmarks/measured_specimens.py FOLDER [--count 6] [--seed 1] [--families NAME...]

Tests are simulated under the records of FOLDER by code that shares nothing with the package
(`tests/nonlinear_specimens.py`). Everything that is stated is exact; intervals hold noise and specimen.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[2])]

from nonlinear_specimens import FAMILIES, SimulatedTest, simulate  # noqa: E402

from reliab.assessment.measured_specimen import MeasuredSpecimen, rebuild_with_force  # noqa: E402
from reliab.motions import Motion, load_motions  # noqa: E402
from reliab.structures import Structure  # noqa: E402

_STEP = 1.0 / 1024.0
_SECONDS = 40.0
_ERRORS = (0.003, 0.3)


def main() -> None:
    """Print a row for each family."""
    parser = argparse.ArgumentParser(description="True and computed errors of nonlinear specimens.")
    parser.add_argument("folder", type=Path)
    parser.add_argument(
        "--families", nargs="+", default=list(FAMILIES), choices=list(FAMILIES), metavar="NAME"
    )
    parser.add_argument("--count", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--decibels", type=float, default=40.0)
    asked = parser.parse_args()
    motions = list(load_motions(asked.folder))
    print("family | stated/true, 5–95 % | within 10, 25 % | interval holds | corrected/original | seconds")
    for family in asked.families:
        draw = np.random.default_rng([asked.seed, list(FAMILIES).index(family)])
        rows = np.array([_row(family, motions, draw, asked.decibels) for _ in range(asked.count)])
        print(_line(family, rows), flush=True)


def _row(family: str, motions: list[Motion], draw: np.random.Generator, decibels: float) -> list[float]:
    test = _drawn(family, motions, draw, decibels)
    begun = time.process_time()
    learned = judge(test)
    seconds = time.process_time() - begun
    size = learned.rebuilt.rms
    left = np.sqrt(np.mean((learned.rebuilt.reference - test.exact) ** 2))
    original = np.sqrt(np.mean((test.moved - test.exact) ** 2))
    return [size.value / test.error, size.low <= test.error <= size.high, left / original, seconds]


def _drawn(family: str, motions: list[Motion], draw: np.random.Generator, decibels: float) -> SimulatedTest:
    """A test whose error is neither tiny nor of a loop that diverges."""
    times = np.arange(0.0, _SECONDS, _STEP)
    while True:
        motion = motions[draw.integers(len(motions))]
        ground = np.interp(times, motion.time_step * np.arange(motion.acceleration.size), motion.acceleration)
        ground[times > motion.time_step * motion.acceleration.size] = 0.0
        try:
            test = simulate(family, -ground, _STEP, draw, decibels=decibels)
        except ArithmeticError:  # the loop diverges
            continue
        if np.isfinite(test.command).all() and _ERRORS[0] < test.error < _ERRORS[1]:
            return test


def judge(test: SimulatedTest) -> MeasuredSpecimen:
    """Compute the error of a simulated test from its command, displacement and force."""
    loop = test.loop
    return rebuild_with_force(
        test.command,
        test.measured,
        test.force,
        test.step,
        Structure(
            frequency=loop.frequency, damping_ratio=loop.damping_ratio, experimental_fraction=loop.share
        ),
        1.0,
    )


def _line(family: str, rows: np.ndarray) -> str:
    ratio, held, left, seconds = rows.T
    low, high = np.quantile(ratio, [0.05, 0.95])
    near = [np.mean(np.abs(ratio - 1.0) < width) for width in (0.1, 0.25)]
    return (
        f"{family} | {low:.2f}–{high:.2f} | {near[0]:.0%}, {near[1]:.0%} | {np.mean(held):.0%} | "
        f"{np.median(left):.2f} | {np.mean(seconds):.1f}"
    )


if __name__ == "__main__":
    main()
