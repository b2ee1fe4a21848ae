"""How many independent observations the tests hold of an error that follows the motion."""

import numpy as np

from reliab.discrepancy.fitting.problem import Problem

MOST_OF_A_TEST = 24.0
"""Largest number of observations in one test: later swings repeat the earlier ones."""

_FEWEST = 4.0


def observations(problem: Problem) -> dict[int, float]:
    """Count the swings of the motion, up to a number in each test.

    What a model misses is much the same along a swing and differs between swings of different size and
    speed; samples, or frequencies, are no independent observations of it.
    """
    counts = {}
    for test in {segment.test for segment in problem.segments}:
        motion = problem.block.motions[test]
        displacement, velocity = motion.values[0] - motion.values[0].mean(), motion.values[1]
        turn = float(np.sqrt(np.mean(velocity**2) / max(float(np.mean(displacement**2)), 1e-300)))
        share = sum(s.end - s.begin for s in problem.segments if s.test == test) / problem.block.rate
        counts[test] = min(max(turn / np.pi * share, _FEWEST), MOST_OF_A_TEST)
    return counts
