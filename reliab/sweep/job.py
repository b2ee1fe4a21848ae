"""What a worker needs to solve the motions of a sweep."""

from dataclasses import dataclass

from reliab.motions import Motion, MotionSuite
from reliab.sweep.request import SweepRequest
from reliab.sweep.solve import MotionResults, solve_motion

Solved = tuple[int, Motion, list[MotionResults]]
"""Index of a motion, the motion, and its results for each window."""


@dataclass(frozen=True, kw_only=True)
class SweepJob:
    """A suite of motions and the request for it."""

    motions: MotionSuite  # The suite
    request: SweepRequest  # Structures, actuators and windows

    def solve(self, index: int) -> Solved:
        """Read and simulate one motion."""
        motion = self.motions[index]
        return index, motion, solve_motion(motion, self.request)
