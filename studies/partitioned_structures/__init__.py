"""Comparison of predictions of a partitioned test's error: laws, tracking over frequency, rebuilt error.

Tests are run in the digital laboratory: structures with different parts in the laboratory, with random servos
that are compensated well, too little or too much. Each prediction is held against the simulated error.
"""

from .drawing import PartitionedTest, draw_tests
from .predictions import PREDICTIONS, mean_law
from .running import ratios, run_tests
from .structures import partitioned_structures, shares_of_structures

__all__ = [
    "PREDICTIONS",
    "PartitionedTest",
    "draw_tests",
    "mean_law",
    "partitioned_structures",
    "ratios",
    "run_tests",
    "shares_of_structures",
]
