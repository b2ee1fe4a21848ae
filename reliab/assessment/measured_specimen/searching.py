"""Search for the traits of a law of hysteresis with which it explains a specimen's force best.

Beside the law stand springs, dashpots and constants whose coefficients follow from the traits by non-negative
least squares (variable projection: Golub and Pereyra 1973, SIAM Journal on Numerical Analysis 10, 413).
Traits are drawn about their start, and the best of them are improved by the method of Levenberg and
Marquardt.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.assessment.measured_specimen.elements import Elements, Kind, elements_of_family, with_traits
from reliab.assessment.measured_specimen.hysteresis import (
    PEAK_TRAITS,
    REVERSAL_TRAITS,
    SMOOTH_TRAITS,
    STRUT_TRAITS,
)
from reliab.assessment.measured_specimen.path import MeasuredPath, fit

_LAWS = {
    Kind.SMOOTH_PINCHED: SMOOTH_TRAITS,
    Kind.TOWARDS_PEAKS: PEAK_TRAITS,
    Kind.FROM_REVERSALS: REVERSAL_TRAITS,
    Kind.STRUT: STRUT_TRAITS,
}
_DRAWN = 40
_IMPROVED = 2  # the best of those that are drawn
_STEPS = 12
_SPREAD = 1.0  # of what is drawn, in logits
_DIFFERENCE = 0.02  # in logits, by which derivatives are taken
_PRIOR = 2e-3  # of the force, for a logit's distance from its start
_YIELDS = ("size", 0.01, 2.0, 0.4)  # over the largest displacement
_SEED = 20
_GAIN = 1e-3  # of the squared misfit, below which a step is the last one
_FARTHEST = 1.5  # logits, that a step goes at most


@dataclass(frozen=True, kw_only=True, eq=False)
class FoundLaw:
    """A law of hysteresis with the traits that explain a force best, and how they hang on parts of a test."""

    kind: Kind
    bounds: Array  # Least and largest size [m] and traits, shape (2, traits)
    logits: Array  # Of size and traits between their bounds, shape (traits,)
    moves: Array  # Change of the logits by a unit of weight more of each block, shape (blocks, traits)
    speed: float  # Velocity at which a dashpot gives its size [m/s]

    def elements(self, weights: Array | None = None) -> Elements:
        """Give the law; `weights` of blocks, shape (blocks,): as if they counted so (a step of Newton's)."""
        step = 0.0 if weights is None else np.clip((weights - 1.0) @ self.moves, -_FARTHEST, _FARTHEST)
        least, most = self.bounds
        size, *traits = least * (most / least) ** scipy.special.expit(self.logits + step)
        return with_traits(self.kind, size, np.array(traits), self.speed)


def search_laws(path: MeasuredPath) -> tuple[FoundLaw, ...]:
    """Search for the traits of each law of hysteresis that explain the force best."""
    beside = path.responses(elements_of_family("laws", path.largest, path.speed))
    return tuple(_search(path, kind, traits, beside) for kind, traits in _LAWS.items())


def _search(
    path: MeasuredPath,
    kind: Kind,
    traits: Sequence[tuple[str, float, float, float]],
    beside: Array,
) -> FoundLaw:
    """Find size and traits of one law; `beside`: what stands beside it, as it is seen, shape (rows, m)."""
    _, *columns = zip(_YIELDS, *traits, strict=True)
    least, most, start = np.array(columns, dtype=np.float64)
    begin = scipy.special.logit(np.log(start / least) / np.log(most / least))
    bounds = np.array([least, most])
    bounds[:, 0] *= path.largest
    wanted = path.force_seen
    unit = float(np.sqrt(np.sum(wanted**2)))

    def law(logits: Array, moves: Array) -> FoundLaw:
        return FoundLaw(kind=kind, bounds=bounds, logits=logits, moves=moves, speed=path.speed)

    def missed(logits: Array) -> Array:
        rows = np.vstack([path.responses(law(logits, np.empty(0)).elements()), beside])
        left = (wanted - fit(rows, wanted) @ rows) / unit
        return np.concatenate([left, _PRIOR * (logits - begin)])

    drawn = begin + _SPREAD * np.random.default_rng(_SEED).standard_normal((_DRAWN, begin.size))
    drawn[0] = begin
    first = sorted(drawn, key=lambda logits: float(np.sum(missed(logits) ** 2)))[:_IMPROVED]
    found = min((_improved(missed, logits) for logits in first), key=lambda one: one[1])[0]
    return law(found, _moves(missed, found, path.blocks))


def _moves(missed: Callable[[Array], Array], logits: Array, blocks: NDArray[np.int64]) -> Array:
    """Change of logits by a unit of weight more of each block, shape (blocks, logits)."""
    left = missed(logits)
    columns = _derivatives(missed, logits, left)
    slopes = (columns * left)[:, : blocks.size]
    of_blocks = np.array([np.bincount(blocks, row) for row in slopes])
    return np.asarray(-np.linalg.solve(columns @ columns.T, of_blocks).T)


def _derivatives(missed: Callable[[Array], Array], logits: Array, left: Array) -> Array:
    """Differentiate what is missed by each logit, shape (logits, m); `left`: what is missed with these."""
    steps = _DIFFERENCE * np.eye(logits.size)
    return np.array([(missed(logits + step) - left) / _DIFFERENCE for step in steps])


def _improved(missed: Callable[[Array], Array], logits: Array) -> tuple[Array, float]:
    """Logits after some steps of Levenberg and Marquardt, and the squared misfit with them."""
    left, damping = missed(logits), 1e-2
    misfit = float(left @ left)
    for _ in range(_STEPS):
        columns = _derivatives(missed, logits, left)
        normal, slope = columns @ columns.T, columns @ left
        before = misfit
        for _ in range(4):
            step = np.linalg.solve(normal + damping * np.diag(np.diag(normal) + 1e-12), -slope)
            tried = logits + np.clip(step, -_FARTHEST, _FARTHEST)
            now = missed(tried)
            if now @ now < misfit:
                logits, left, misfit = tried, now, float(now @ now)
                damping *= 0.3
                break
            damping *= 5.0
        if misfit > (1.0 - _GAIN) * before:
            break
    return logits, misfit
