"""Coming tests drawn from what the rig's tests teach: amplitude, delay, remainder, and the rest."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from reliab.core.arrays import Array
from reliab.rig.learning.learned import Learned
from reliab.rig.memory import Memory, NextTest
from reliab.structures.structure import Structure

DRAWS: Final = 1000


@dataclass(frozen=True, kw_only=True, eq=False)
class Draws:
    """Drawn tests, each an array of one shape."""

    amplitude: Array
    delay_ms: Array
    remainder: Array
    ratio: Array  # Error over what amplitude, delay and remainder explain

    def errors(self, of_a: Array, of_b: Array) -> Array:
        """Errors by the parameters a [-] and b [ms²] of ellipses over the squared error."""
        squares = ((self.amplitude - 1.0) ** 2 + self.remainder**2) / of_a + self.delay_ms**2 / of_b
        return np.sqrt(squares) * self.ratio


def learn_tracking(memory: Memory, coming: NextTest) -> dict[str, Learned]:
    """Learn amplitude, delay and remainder."""
    return {
        "A": memory.learn(memory.amplitude, coming),
        "d_ms": memory.learn(memory.delay, coming),
        "remainder": memory.learn(memory.log_remainder, coming),
    }


def learn_tests(memory: Memory, coming: NextTest) -> dict[str, Learned]:
    """Learn what tests are drawn from: their tracking, and what this does not explain of their errors."""
    return {**learn_tracking(memory, coming), "ratio": memory.learn(_log_ratio(memory), coming)}


def draw_tests(memory: Memory, learned: dict[str, Learned], coming: NextTest, structure: Structure) -> Draws:
    """Draw coming tests from what was learned.

    The residuals of one test are drawn together, so that what goes together in the tests goes together in the
    draws; with few tests they are longer, as in Student's t distribution.
    """
    others = memory.circumstances_of(coming, structure)
    rng = np.random.default_rng(0)
    count = len(memory.table)
    places = rng.integers(count, size=DRAWS)
    longer = np.sqrt((count - 1.0) / rng.chisquare(count - 1.0, DRAWS))
    drawn = {}
    for name, quantity in learned.items():
        mean, deviation = quantity.predict(others)
        drawn[name] = mean[0] + deviation[0] * longer * quantity.left_out.residuals[places]
    return Draws(
        amplitude=drawn["A"],
        delay_ms=drawn["d_ms"],
        remainder=np.exp(np.minimum(drawn["remainder"], 5.0)),
        ratio=np.exp(np.clip(drawn["ratio"], -20.0, 20.0)),
    )


def _log_ratio(memory: Memory) -> Array:
    """Logarithm of each test's error over what its gain, delay and remainder explain of it."""
    of_a, of_b = memory.table.numbers("own_a"), memory.table.numbers("own_b_ms2")
    known_tests = Draws(
        amplitude=memory.amplitude,
        delay_ms=memory.delay,
        remainder=np.exp(memory.log_remainder),
        ratio=np.ones(of_a.size),
    )
    ratio = memory.log_error - np.log(np.maximum(known_tests.errors(of_a, of_b), 1e-10))
    return np.where(np.isfinite(ratio), ratio, 0.0)
