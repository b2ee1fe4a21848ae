"""What a criterion allows at one structure: half an ellipse for delays, and one for leads where it has it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.vocabulary import MILLI, Side

_EDGE_POINTS = 33


@dataclass(frozen=True, kw_only=True, eq=False)
class Actuators:
    """Amplitudes and delays of tests."""

    gain: NDArray[np.float64]  # Amplitude A [-], shape (tests,)
    delay: NDArray[np.float64]  # Equivalent delay d [s], shape (tests,); leads are negative


@dataclass(frozen=True, kw_only=True)
class Region:
    """Half an ellipse (A − 1)²/a + d²/b ≤ 1."""

    a: float  # a, b: Its parameters [-] and [ms²]; zero where no test but the perfect one is accepted
    b: float
    side: Side = Side.LAG  # Whether it holds for actuators that are late or early

    def accepts(self, tests: Actuators) -> NDArray[np.bool_]:
        """Which tests, all of this side, it accepts; shape (tests,)."""
        if not (self.a > 0.0 and self.b > 0.0):
            return np.zeros(tests.gain.size, dtype=np.bool_)
        index = np.square(tests.gain - 1.0) / self.a + np.square(MILLI * tests.delay) / self.b
        return np.asarray(index <= 1.0)

    def edge(self) -> Actuators:
        """Points on the edge, from the greatest amplitude over the greatest delay to the least amplitude.

        Returns 33 points, so close that the error between two of them exceeds that of both by less than 0.1
        %.
        """
        angle = np.linspace(0.0, np.pi, _EDGE_POINTS)
        delay = self.side.sign * np.sqrt(self.b) * np.sin(angle) / MILLI
        delay[[0, -1]] = 0.0
        return Actuators(gain=1.0 + np.sqrt(self.a) * np.cos(angle), delay=delay)
