"""Learn from a test's own force what its specimen does, and say on held-out parts how well.

Coefficients are found by non-negative least squares over the smoothed force, elements whose size bears a part
are refined step by step, and four quarters of the test, made of short blocks, are predicted from the others.
Families weigh the more the better they predict; where a spring and a dashpot predict as well as any other,
the specimen is linear: others could only follow the noise.

Beside a law of hysteresis stand springs, dashpots and constants whose coefficients follow from its traits
(variable projection: Golub and Pereyra 1973, SIAM Journal on Numerical Analysis 10, 413). Traits are drawn
about their start, and the best of them are improved by the method of Levenberg and Marquardt.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.assessment.measured_specimen.elements import (
    FAMILIES,
    LINEAR,
    Elements,
    Kind,
    elements_of_family,
    with_traits,
)
from reliab.assessment.measured_specimen.hysteresis import (
    PEAK_TRAITS,
    REVERSAL_TRAITS,
    SMOOTH_TRAITS,
    STRUT_TRAITS,
)
from reliab.assessment.measured_specimen.path import MeasuredPath, fit
from reliab.core.arrays import Array
from reliab.core.progress import show_task

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

_REFINEMENTS = (1.15, 1.07, 1.035, 1.017)
_QUARTERS = 4
_NOISIER = 1.1  # times the noise that is estimated, which held-out parts may leave
_BETTER = 0.9  # times what is left unexplained, below which a lag of the force is believed
_DIGITS = 7  # of the share that a row has in another, to which two rows are alike
_AS_WELL = 1.01  # times what the best family leaves unexplained, up to which a specimen is linear
_PREFERENCE = 4.0  # power of what is missed by which a family weighs less
_LEAST_PART = 5e-4  # of the force, below which an element is left out
_GREAT_PART = 0.05  # of the force, above which a law's traits are drawn
_UNSEEN = 1e-3  # of the largest displacement, up to which nothing is known of an element that moved so far
_REFINED = ("plain", "gaps", "smooth", "memory", "all")


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
    """Search for the traits of each law of hysteresis that explain the force best; this takes longest."""
    beside = path.responses(elements_of_family("laws", path.largest, path.speed))
    trials, total = 0, sum(_DRAWN + _IMPROVED * _STEPS * _trials_in_step(traits) for traits in _LAWS.values())
    with show_task("Learning the specimen") as progress:

        def report(further: int) -> None:
            nonlocal trials
            trials += further
            progress(trials, total)

        return tuple(_search(path, kind, traits, beside, report) for kind, traits in _LAWS.items())


def _trials_in_step(traits: Sequence[object]) -> int:
    """How many times a step of Levenberg and Marquardt computes what is missed, about."""
    return len(traits) + 2


def _search(
    path: MeasuredPath,
    kind: Kind,
    traits: Sequence[tuple[str, float, float, float]],
    beside: Array,
    report: Callable[[int], None],
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

    def misfit(logits: Array) -> float:
        report(1)
        return float(np.sum(missed(logits) ** 2))

    first = sorted(drawn, key=misfit)[:_IMPROVED]
    steps = partial(report, _trials_in_step(traits))
    found = min((_improved(missed, logits, steps) for logits in first), key=lambda one: one[1])[0]
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


def _improved(
    missed: Callable[[Array], Array], logits: Array, report: Callable[[], None]
) -> tuple[Array, float]:
    """Logits after some steps of Levenberg and Marquardt, and the squared misfit with them."""
    left, damping = missed(logits), 1e-2
    misfit = float(left @ left)
    for step_number in range(_STEPS):
        report()
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
            for _ in range(step_number + 1, _STEPS):
                report()  # of steps that are not needed
            break
    return logits, misfit


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnedSpecimen:
    """A specimen as one family of elements has learned it."""

    family: str  # Name of the family
    elements: Elements  # Those that bear a part
    coefficients: Array  # Of the elements [N/m], shape (elements,)
    held_out: float  # RMS of what held-out parts of the force leave unexplained, over that of the force [-]
    missed: float  # The same without what noise explains [-]
    laws: tuple[FoundLaw, ...] = ()  # Laws of hysteresis among the elements whose traits are drawn

    @property
    def linear(self) -> bool:
        """Whether it is a spring and a dashpot."""
        return self.family == LINEAR

    def with_weights(self, weights: Array) -> tuple["LearnedSpecimen", NDArray[np.int64]]:
        """Give it with laws as weights of blocks, shape (blocks,), would have them, and their places."""
        elements = reduce(Elements.with_law, (law.elements(weights) for law in self.laws), self.elements)
        places = np.flatnonzero(np.isin(elements.kinds, [law.kind for law in self.laws]))
        return replace(self, elements=elements), places


def learn_specimen(path: MeasuredPath) -> list[LearnedSpecimen]:
    """Learn a specimen with every family of elements; the best comes first, or the linear one if it is."""
    found = search_laws(path)
    laws = reduce(Elements.beside, (law.elements() for law in found))
    elements = {family: elements_of_family(family, path.largest, path.speed) for family in FAMILIES}
    elements |= {family: _refined(path, elements[family]) for family in _REFINED}
    elements |= {"laws": elements["laws"].beside(laws), "everything": elements["all"].beside(laws)}
    learned = [_learned(path, family, elements[family], found) for family in FAMILIES]
    as_well = max(_AS_WELL * min(specimen.held_out for specimen in learned), _LEAST_PART)
    return sorted(
        learned, key=lambda specimen: (not specimen.linear or specimen.held_out > as_well, specimen.held_out)
    )


def weights_of(learned: Sequence[LearnedSpecimen]) -> Array:
    """Share of each family, shape (families,)."""
    if learned[0].linear:
        return np.asarray(np.arange(len(learned)) == 0, dtype=np.float64)
    missed = np.array([specimen.held_out for specimen in learned])
    shares = (np.maximum(missed, np.finfo(float).tiny) / missed.min()) ** -_PREFERENCE
    return np.asarray(shares / shares.sum())


def _refined(path: MeasuredPath, elements: Elements) -> Elements:
    """Refine the sizes of elements that bear a part."""
    wanted = path.force_seen
    for ratio in _REFINEMENTS:
        seen = path.responses(elements)
        distinct = _distinct(seen)
        elements = elements.only(distinct).refined(fit(seen[distinct], wanted), ratio, path.largest)
    return elements


def _distinct(rows: Array) -> NDArray[np.int64]:
    """Places of rows, shape (rows, n), of which none is a multiple of another."""
    shares = rows @ np.random.default_rng(0).standard_normal(rows.shape[1])
    shares = shares / (np.linalg.norm(rows, axis=1) + np.finfo(float).tiny)
    return np.sort(np.unique(np.round(shares, _DIGITS), return_index=True)[1])


def _learned(
    path: MeasuredPath, family: str, elements: Elements, found: Sequence[FoundLaw]
) -> LearnedSpecimen:
    """Fit elements, and predict what had no part in the fit."""
    wanted = path.force_seen
    seen = path.responses(elements)
    distinct = _distinct(seen)
    distinct = distinct[np.abs(seen[distinct]).max(axis=1) > _UNSEEN * path.largest]
    elements, seen = elements.only(distinct), seen[distinct]
    coefficients = fit(seen, wanted)
    sizes = np.sqrt(np.mean(seen**2, axis=1) / np.mean(wanted**2))
    bears = coefficients * sizes > _LEAST_PART
    coefficients[bears] = fit(seen[bears], wanted)
    bears &= coefficients > 0.0
    held_out = _held_out(seen[bears], wanted, path.blocks)
    borne, share = elements.only(bears), coefficients[bears] * sizes[bears]
    return LearnedSpecimen(
        family=family,
        elements=borne,
        coefficients=coefficients[bears],
        held_out=held_out,
        missed=float(np.sqrt(max(held_out**2 - (_NOISIER * path.noisy) ** 2, 0.0))),
        laws=tuple(law for law in found if law.kind in borne.kinds[share > _GREAT_PART]),
    )


def late_by(path: MeasuredPath, specimen: LearnedSpecimen, late: Array) -> float:
    """Time by which a force seems late [s]: held-out parts are then predicted better; 0 where they are not.

    `late`: what a unit of lag adds to the force [N/s], shape (n,). No specimen that stores and dissipates
    gives such a force; one that is early looks like a dashpot, and is not found.
    """
    wanted = path.force_seen
    seen = path.responses(specimen.elements)
    rows = np.vstack([seen, path.thinned(late)])
    better = _held_out(rows, wanted, path.blocks) < _BETTER * specimen.held_out
    return float(fit(rows, wanted)[-1]) if better else 0.0


def _held_out(rows: Array, wanted: Array, blocks: NDArray[np.int64]) -> float:
    """RMS of what quarters leave unexplained that had no part in the fit, over that of the force."""
    left = 0.0
    for quarter in range(_QUARTERS):
        outside = (blocks % _QUARTERS != quarter).astype(np.float64)
        missed = wanted - fit(rows, wanted, outside) @ rows
        left += float(np.sum((1.0 - outside) * missed**2))
    return float(np.sqrt(left / np.sum(wanted**2)))
