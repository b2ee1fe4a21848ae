"""Lags of recorded forces as learned specimens show them, beside the true ones.

Tests of specimens of 16 kinds, none of which is built like the elements that learn them, are recorded with a
displacement that is read early or late. `python tests/benchmarks/lag_of_force.py FOLDER --tests 3 --seed 12`
prints a line for each kind, FOLDER being one of records with a catalog.csv. A force may seem earlier than it
is, by the viscous damping of its specimen, but not later.
"""

from importlib import import_module

import numpy as np
import paths  # noqa: F401 - makes the studies importable
from benchmark_script import argument_parser

from reliab import load_motions
from reliab.assessment.measured_specimen.force_channel import NOTHING_STATED
from reliab.assessment.rebuild import rebuild
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure
from reliab.study.description import PACKAGE

simulated_tests = import_module(f"{PACKAGE}.measured_specimen.simulated_tests")

STEP = 1.0 / 512.0
LONGEST = 30.0  # s


def draw_test(family, generator, motions):
    """Simulate a test of a specimen of one kind."""
    while True:
        motion = motions[int(generator.integers(len(motions)))]
        times = np.arange(0.0, min(motion.duration, LONGEST), STEP)
        load = -np.interp(times, np.arange(motion.acceleration.size) * motion.time_step, motion.acceleration)
        try:
            test = simulated_tests.simulate(family, load, STEP, generator)
        except ArithmeticError:
            continue
        if 0.005 < test.error < 0.3:
            return test


def find_lag(test, lag):
    """Find the lag of a force [s] whose displacement was read early by `lag` [s]."""
    structure = Structure(
        frequency=test.loop.frequency,
        damping_ratio=test.loop.damping_ratio,
        experimental_fraction=test.loop.share,
    )
    times = STEP * np.arange(test.measured.size)
    measured = np.interp(times + lag, times, test.measured)
    partition = Partition.from_structure(structure)
    error = rebuild(test.command, measured, STEP, partition, force=test.force, force_channel=NOTHING_STATED)
    return error.specimen.test.apparent_lag


def main():
    options = argument_parser(__doc__, "folder", tests=3, seed=1).parse_args()
    motions, distances = load_motions(options.folder), []
    for number, family in enumerate(simulated_tests.FAMILIES):
        words = []
        for test_number in range(options.tests):
            generator = np.random.default_rng([options.seed, number, test_number])
            test, lag = draw_test(family, generator, motions), float(generator.uniform(-2e-3, 2e-3))
            late = find_lag(test, lag)
            distances.append((late.value - lag) / late.deviation)
            words.append(f"{1e3 * lag:+.1f}: {1e3 * late.value:+.2f} ± {1e3 * late.deviation:.2f}")
        print(f"{family:16s} true: seen [ms]  {'   '.join(words)}", flush=True)
    above = np.array(distances)
    print(f"seen later than true by more than 1.64 deviations: {np.mean(above > 1.64):.3f} of {above.size}")


if __name__ == "__main__":
    main()
