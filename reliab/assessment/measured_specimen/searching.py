"""Search for the traits of a law of hysteresis with which it explains a specimen's force best.

Beside the law stand springs, dashpots and constants whose coefficients follow from the traits by non-negative
least squares (variable projection: Golub and Pereyra 1973, SIAM Journal on Numerical Analysis 10, 413).
Traits are drawn about their start, and the best of them are improved by the method of Levenberg and
Marquardt.
"""

from collections.abc import Callable, Sequence
from functools import reduce

import numpy as np
import scipy

from reliab.arrays import Array
from reliab.assessment.measured_specimen.elements import Elements, Kind, elements_of_family, with_traits
from reliab.assessment.measured_specimen.hysteresis import PEAK_TRAITS, REVERSAL_TRAITS, SMOOTH_TRAITS
from reliab.assessment.measured_specimen.path import MeasuredPath, fit

_LAWS = {
    Kind.SMOOTH_PINCHED: SMOOTH_TRAITS,
    Kind.TOWARDS_PEAKS: PEAK_TRAITS,
    Kind.FROM_REVERSALS: REVERSAL_TRAITS,
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


def search_laws(path: MeasuredPath) -> Elements:
    """Laws of hysteresis with the traits that explain the force best."""
    beside = elements_of_family("laws", path.largest, path.speed)
    rows = path.responses(beside)
    found = [_search(path, kind, traits, rows) for kind, traits in _LAWS.items()]
    return reduce(Elements.beside, found)


def _search(
    path: MeasuredPath,
    kind: Kind,
    traits: Sequence[tuple[str, float, float, float]],
    beside: Array,
) -> Elements:
    """Find size and traits of one law; `beside`: what stands beside it, as it is seen, shape (rows, m)."""
    _, least, most, start = (np.array(column) for column in zip(_YIELDS, *traits, strict=True))
    least, most, start = (column.astype(np.float64) for column in (least, most, start))
    begin = scipy.special.logit(np.log(start / least) / np.log(most / least))
    wanted = path.force_seen
    unit = float(np.sqrt(np.mean(wanted**2)))

    def element(logits: Array) -> Elements:
        values = least * (most / least) ** scipy.special.expit(logits)
        return with_traits(kind, values[0] * path.largest, values[1:], path.speed)

    def missed(logits: Array) -> Array:
        row = path.responses(element(logits))
        rows = np.vstack([row, beside])
        left = (wanted - fit(rows, wanted) @ rows) / (unit * np.sqrt(wanted.size))
        return np.concatenate([left, _PRIOR * (logits - begin)])

    drawn = begin + _SPREAD * np.random.default_rng(_SEED).standard_normal((_DRAWN, begin.size))
    drawn[0] = begin
    first = sorted(drawn, key=lambda logits: float(np.sum(missed(logits) ** 2)))[:_IMPROVED]
    return element(min((_improved(missed, logits) for logits in first), key=lambda one: one[1])[0])


def _improved(missed: Callable[[Array], Array], logits: Array) -> tuple[Array, float]:
    """Logits after some steps of Levenberg and Marquardt, and the squared misfit with them."""
    left, damping = missed(logits), 1e-2
    misfit = float(left @ left)
    for _ in range(_STEPS):
        columns = np.array(
            [(missed(logits + _DIFFERENCE * unit) - left) / _DIFFERENCE for unit in np.eye(logits.size)]
        )
        normal, slope = columns @ columns.T, columns @ left
        before = misfit
        for _ in range(4):
            step = np.linalg.solve(normal + damping * np.diag(np.diag(normal) + 1e-12), -slope)
            tried = logits + np.clip(step, -1.5, 1.5)
            now = missed(tried)
            if now @ now < misfit:
                logits, left, misfit = tried, now, float(now @ now)
                damping *= 0.3
                break
            damping *= 5.0
        if misfit > (1.0 - _GAIN) * before:
            break
    return logits, misfit
