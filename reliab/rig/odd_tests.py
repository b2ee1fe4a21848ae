"""Odd tests among ordinary ones: a share of tests that stray far, learned from a rig's own tests.

A score z of an ordinary test is standard normal, that of an odd one follows Student's t distribution of two
degrees of freedom, five times as wide. After a step an ordinary test is normal about it, or, where the step
is far larger than supposed, anywhere on its side. What a test says for a step is the logarithm of the ratio
of its densities after it and before (Page 1954); a test far off says the less the more odd tests there are.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from reliab.arrays import Array

_WIDE: Final = 5.0  # spread of odd tests
_SUPPOSED: Final = (0.25, 25.0)  # odd tests, of so many, that are supposed before any is seen
_FAR: Final = 0.1  # share of the steps that are far larger than supposed
_REMEMBERED: Final = 300.0
_MOST: Final = 2.5  # that one test says, lest a single one is taken for a change
_ROUNDS: Final = 16
_CAUTIOUS: Final = 8  # first rounds, in which no test is taken for odd, but those far off count less
_NEAR: Final = 1.5  # spreads, within which a test counts wholly in them


def odd_density(score: float) -> float:
    """Density of the score of an odd test."""
    return float((1.0 + 0.5 * (score / _WIDE) ** 2) ** -1.5) / (2.0 * math.sqrt(2.0) * _WIDE)


def _normal_density(score: float) -> float:
    return math.exp(-0.5 * score * score) / math.sqrt(2.0 * math.pi)


@dataclass
class OddTests:
    """How many of the tests so far were odd."""

    odd: float = 0.0
    tests: float = 0.0

    @property
    def share(self) -> float:
        """Share of odd tests."""
        return (self.odd + _SUPPOSED[0]) / (self.tests + _SUPPOSED[1])

    def ordinary(self, score: float) -> float:
        """Probability that a test is an ordinary one."""
        ordinary = (1.0 - self.share) * _normal_density(score)
        return ordinary / (ordinary + self.share * odd_density(score))

    def learn(self, ordinary: float) -> None:
        """Count a test that is ordinary with some probability."""
        memory = min(1.0, _REMEMBERED / (self.tests + 1.0))
        self.odd = memory * (self.odd + 1.0 - ordinary)
        self.tests = memory * (self.tests + 1.0)

    def evidence(self, score: float, step: float) -> float:
        """Logarithm of how much more probable a score is after a step, on its side, than before it."""
        far = 2.0 * odd_density(score) * (score * step > 0.0)
        after = (1.0 - _FAR) * _normal_density(score - step) + _FAR * far
        odd = self.share * odd_density(score)
        before = (1.0 - self.share) * _normal_density(score) + odd
        return min(math.log(((1.0 - self.share) * after + odd) / before), _MOST)


@dataclass(frozen=True, kw_only=True, eq=False)
class OrdinaryTests:
    """Level and effects of ordinary tests, and which ones are."""

    effects: Array  # The level first
    unsure: Array  # Covariance of `effects`, in squared spreads
    spread: float
    ordinary: Array  # Probability of each test


def ordinary_tests(values: Array, rows: Array, unsure: Array) -> OrdinaryTests:
    """Tell ordinary tests from odd ones by expectation and maximisation.

    `rows`, shape (tests, effects): what each depends on, the level first; `unsure`: covariance before them.
    """
    effects: Array = np.zeros(rows.shape[1])
    effects[0] = np.median(values)
    spread = 1.4826 * float(np.median(np.abs(values - effects[0]))) or float(values.std()) or 1.0
    odd, prior = OddTests(), np.linalg.inv(unsure)
    for turn in range(_ROUNDS):
        scores = (values - rows @ effects) / spread
        ordinary = np.minimum(1.0, _NEAR / np.maximum(np.abs(scores), _NEAR))
        if turn >= _CAUTIOUS:
            ordinary = np.array([odd.ordinary(score) for score in scores.tolist()])
        odd = OddTests(odd=float((1.0 - ordinary).sum()), tests=float(values.size))
        precision = prior + rows.T @ (ordinary[:, None] * rows)
        effects = np.asarray(np.linalg.solve(precision, rows.T @ (ordinary * values)))
        residuals = values - rows @ effects
        degrees = float(np.trace(np.linalg.solve(precision, precision - prior)))
        squares = float(ordinary @ residuals**2)
        spread = math.sqrt(max(squares / max(float(ordinary.sum()) - degrees, 1.0), 1e-18))
    return OrdinaryTests(
        effects=effects, unsure=np.asarray(np.linalg.inv(precision)), spread=spread, ordinary=ordinary
    )
