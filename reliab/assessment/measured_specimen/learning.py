"""Learn from a test's own force what its specimen does, and say on held-out parts how well.

Coefficients are found by non-negative least squares over the smoothed force, elements whose size bears a part
are refined step by step, and four quarters of the test, made of short blocks, are predicted from the others.
Families weigh the more the better they predict; where a spring and a dashpot predict as well as any other,
the specimen is linear: others could only follow the noise. Force and elements pass one filter; near the ends
of a test, where it reaches beyond what was recorded, they are not compared.

Beside a law of hysteresis stand springs, dashpots and constants whose coefficients follow from its traits
(variable projection: Golub and Pereyra 1973, SIAM Journal on Numerical Analysis 10, 413). Traits are drawn
about their start, and the best of them are improved by the method of Levenberg and Marquardt.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial, reduce

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.assessment.measured_specimen.elements import Elements, Kind, law_with_traits
from reliab.assessment.measured_specimen.families import FAMILIES, LINEAR, elements_of_family
from reliab.assessment.measured_specimen.hysteresis import (
    PEAK_TRAITS,
    REVERSAL_TRAITS,
    SMOOTH_TRAITS,
    STRUT_TRAITS,
)
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.core.arrays import Array
from reliab.core.progress import show_task
from reliab.core.stated_value import StatedValue
from reliab.signals.filters import REACH

_RIDGE = 1e-8  # of an element's own mean square
_UNEXCITED_SHARE = 1e-4  # of the most excited element, below which one bears next to nothing
_SAMPLES_PER_PERIOD = 4.0  # samples in a period of the highest frequency that is kept
_ITERATIONS = 100  # for each element


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredPath:
    """What is known of a specimen: the path along which it was moved, and its force."""

    displacement: Array  # Smoothed, shape (n,) [m]
    force: Array  # Smoothed, shape (n,) [N]
    time_step: float  # Step [s]
    noise: SensorNoise  # Its filter is passed by elements, too
    block: float  # Length of a block [s]
    noisy: float  # RMS of the noise of force and displacement within the band, over that of the force [-]

    @cached_property
    def energy_share(self) -> Array:
        """Work done on the specimen so far, to and fro, over that of the whole test, shape (n,)."""
        work = np.cumsum(np.abs(np.gradient(self.displacement) * (self.force - self.force.mean())))
        return np.asarray(work / work[-1])

    @property
    def largest(self) -> float:
        """Largest displacement [m]."""
        return float(np.abs(self.displacement).max())

    @cached_property
    def speed(self) -> float:
        """Largest speed [m/s]."""
        return float(np.abs(np.gradient(self.displacement, self.time_step)).max())

    @property
    def stride(self) -> int:
        """Number of samples of which one tells all that the filter passes."""
        return max(int(1.0 / (_SAMPLES_PER_PERIOD * self.noise.band * self.time_step)), 1)

    @property
    def reach(self) -> int:
        """Number of samples at either end that the filter sees only one side of."""
        reach = self.noise.filter.size // 2
        return reach if reach <= REACH * self.displacement.size else 0

    @cached_property
    def force_seen(self) -> Array:
        """Force that elements should have, as the channels see it [N], shape (m,)."""
        return np.asarray(self.thin(self.force))

    def thin(self, history: Array) -> Array:
        """Keep the samples of histories, shape (…, n), that are compared, shape (…, m)."""
        inner = slice(self.reach, history.shape[-1] - self.reach, self.stride)
        return np.ascontiguousarray(history[..., inner])

    @property
    def blocks(self) -> NDArray[np.int64]:
        """Number of the block of each sample that is fitted, shape (m,)."""
        times = np.arange(self.force_seen.size) * self.stride * self.time_step
        return np.asarray(times / self.block, dtype=np.int64)

    def responses(self, elements: Elements) -> Array:
        """Displacements of elements along the path, as the channels see them, shape (elements, m)."""
        return self.filter(elements.follow_path(self.displacement, self.time_step, self.energy_share))

    def filter(self, rows: Array) -> Array:
        """Histories, shape (rows, n), as the channels see them, shape (rows, m)."""
        if self.reach == 0:
            return self.thin(rows)
        ahead = -2 * self.reach % self.stride  # zeros that put the first whole sum on a sample that is kept
        filtered = scipy.signal.upfirdn(
            self.noise.filter, np.pad(rows, ((0, 0), (ahead, 0))), down=self.stride, axis=1
        )
        first = (ahead + 2 * self.reach) // self.stride
        return np.asarray(filtered[:, first : first + self.force_seen.size])


def fit(rows: Array, target: Array, weights: Array | None = None) -> Array:
    """Coefficients that are not negative and make rows, shape (elements, n), sum to what is wanted."""
    weighted = rows if weights is None else rows * weights
    squares = weighted @ rows.T
    scale = np.sqrt(np.diag(squares))
    scale = scale + _UNEXCITED_SHARE * float(scale.max())
    normal = squares / np.outer(scale, scale) + _RIDGE * np.eye(scale.size)
    root = np.linalg.cholesky(normal)
    aim = np.linalg.solve(root, weighted @ target / scale)
    return np.asarray(scipy.optimize.nnls(root.T, aim, maxiter=_ITERATIONS * scale.size)[0] / scale)


_LAWS = {
    Kind.SMOOTH_PINCHED: SMOOTH_TRAITS,
    Kind.TOWARDS_PEAKS: PEAK_TRAITS,
    Kind.FROM_REVERSALS: REVERSAL_TRAITS,
    Kind.STRUT: STRUT_TRAITS,
}
_START_COUNT = 40
_DESCENT_COUNT = 2  # the best of those that are drawn
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
# Of what a family misses of the force, that may look like a lag, and of the force that it always may miss.
# With them none of 48 lags seems later than it is by 1.64 deviations (tests/benchmarks/lag_of_force.py)
_SHARE_MISSED, _LEAST_MISSED = 0.3, 0.001
_VISCOUS = (Kind.DASHPOT, Kind.MAXWELL, Kind.FLUID_DAMPER)
_DIGITS = 7  # of the share that a row has in another, to which two rows are alike
_LINEAR_TOLERANCE = 1.01  # times what the best family leaves unexplained, up to which a specimen is linear
_PREFERENCE = 4.0  # power of what is missed by which a family weighs less
_LEAST_PART = 5e-4  # of the force, below which an element is left out
_GREAT_PART = 0.05  # of the force, above which a law's traits are drawn
_UNSEEN = 1e-3  # of the largest displacement, up to which nothing is known of an element that moved so far
_REFINED_FAMILIES = ("oscillators", "plain", "elements")


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
        least, largest = self.bounds
        size, *traits = least * (largest / least) ** scipy.special.expit(self.logits + step)
        return law_with_traits(self.kind, size, np.array(traits), self.speed)


def search_laws(path: MeasuredPath) -> tuple[FoundLaw, ...]:
    """Search for the traits of each law of hysteresis that explain the force best; this takes longest."""
    base_responses = path.responses(elements_of_family("laws", path.largest, path.speed))
    trials, total = (
        0,
        sum(_START_COUNT + _DESCENT_COUNT * _STEPS * _trials_in_step(traits) for traits in _LAWS.values()),
    )
    with show_task("Learning the specimen") as progress:

        def report(count: int) -> None:
            nonlocal trials
            trials += count
            progress(trials, total)

        return tuple(_search(path, kind, traits, base_responses, report) for kind, traits in _LAWS.items())


def _trials_in_step(traits: Sequence[object]) -> int:
    """How many times a step of Levenberg and Marquardt computes what is missed, about."""
    return len(traits) + 2


def _search(
    path: MeasuredPath,
    kind: Kind,
    traits: Sequence[tuple[str, float, float, float]],
    base_responses: Array,
    report: Callable[[int], None],
) -> FoundLaw:
    """Find size and traits of one law beside rows `base_responses`, as they are seen, shape (rows, m)."""
    _, *columns = zip(_YIELDS, *traits, strict=True)
    least, largest, start = np.array(columns, dtype=np.float64)
    begin = scipy.special.logit(np.log(start / least) / np.log(largest / least))
    bounds = np.array([least, largest])
    bounds[:, 0] *= path.largest
    target_force = path.force_seen
    unit = float(np.sqrt(np.sum(target_force**2)))

    def law(logits: Array, moves: Array) -> FoundLaw:
        return FoundLaw(kind=kind, bounds=bounds, logits=logits, moves=moves, speed=path.speed)

    def residual(logits: Array) -> Array:
        rows = np.vstack([path.responses(law(logits, np.empty(0)).elements()), base_responses])
        relative_residual = (target_force - fit(rows, target_force) @ rows) / unit
        return np.concatenate([relative_residual, _PRIOR * (logits - begin)])

    starts = begin + _SPREAD * np.random.default_rng(_SEED).standard_normal((_START_COUNT, begin.size))
    starts[0] = begin

    def misfit(logits: Array) -> float:
        report(1)
        return float(np.sum(residual(logits) ** 2))

    first = sorted(starts, key=misfit)[:_DESCENT_COUNT]
    steps = partial(report, _trials_in_step(traits))
    best_logits = min(
        (_descend(residual, logits, steps) for logits in first), key=lambda descent: descent[1]
    )[0]
    return law(best_logits, _moves(residual, best_logits, path.blocks))


def _moves(residual: Callable[[Array], Array], logits: Array, blocks: NDArray[np.int64]) -> Array:
    """Change of logits by a unit of weight more of each block, shape (blocks, logits)."""
    start_residual = residual(logits)
    columns = _derivatives(residual, logits, start_residual)
    slopes = (columns * start_residual)[:, : blocks.size]
    block_slopes = np.array([np.bincount(blocks, row) for row in slopes])
    return np.asarray(-np.linalg.solve(columns @ columns.T, block_slopes).T)


def _derivatives(residual: Callable[[Array], Array], logits: Array, start_residual: Array) -> Array:
    """Differentiate what is missed by each logit, shape (logits, m); `start_residual` with these."""
    steps = _DIFFERENCE * np.eye(logits.size)
    return np.array([(residual(logits + step) - start_residual) / _DIFFERENCE for step in steps])


def _descend(
    residual: Callable[[Array], Array], logits: Array, report: Callable[[], None]
) -> tuple[Array, float]:
    """Logits after some steps of Levenberg and Marquardt, and the squared misfit with them."""
    current_residual, damping = residual(logits), 1e-2
    misfit = float(current_residual @ current_residual)
    for step_number in range(_STEPS):
        report()
        columns = _derivatives(residual, logits, current_residual)
        normal, slope = columns @ columns.T, columns @ current_residual
        previous_misfit = misfit
        for _ in range(4):
            step = np.linalg.solve(normal + damping * np.diag(np.diag(normal) + 1e-12), -slope)
            candidate = logits + np.clip(step, -_FARTHEST, _FARTHEST)
            now = residual(candidate)
            if now @ now < misfit:
                logits, current_residual, misfit = candidate, now, float(now @ now)
                damping *= 0.3
                break
            damping *= 5.0
        if misfit > (1.0 - _GAIN) * previous_misfit:
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

    def weight_blocks(self, weights: Array) -> tuple["LearnedSpecimen", NDArray[np.int64]]:
        """Give it with laws as weights of blocks, shape (blocks,), would have them, and their places."""
        elements = reduce(Elements.replace_law, (law.elements(weights) for law in self.laws), self.elements)
        places = np.flatnonzero(np.isin(elements.kinds, [law.kind for law in self.laws]))
        return replace(self, elements=elements), places


def learn_specimen(path: MeasuredPath) -> list[LearnedSpecimen]:
    """Learn a specimen with every family of elements; the best comes first, or the linear one if it is."""
    laws_found = search_laws(path)
    laws = reduce(Elements.append, (law.elements() for law in laws_found))
    elements = {family: elements_of_family(family, path.largest, path.speed) for family in FAMILIES}
    elements |= {family: _refine_sizes(path, elements[family]) for family in _REFINED_FAMILIES}
    elements |= {"laws": elements["laws"].append(laws), "all": elements["elements"].append(laws)}
    specimens = [_learn_family(path, family, elements[family], laws_found) for family in FAMILIES]
    misfit_limit = max(_LINEAR_TOLERANCE * min(specimen.held_out for specimen in specimens), _LEAST_PART)
    return sorted(
        specimens,
        key=lambda specimen: (not specimen.linear or specimen.held_out > misfit_limit, specimen.held_out),
    )


def weights_of(specimens: Sequence[LearnedSpecimen]) -> Array:
    """Share of each family, shape (families,)."""
    if specimens[0].linear:
        return np.asarray(np.arange(len(specimens)) == 0, dtype=np.float64)
    misfits = np.array([specimen.held_out for specimen in specimens])
    shares = (np.maximum(misfits, np.finfo(float).tiny) / misfits.min()) ** -_PREFERENCE
    return np.asarray(shares / shares.sum())


def _refine_sizes(path: MeasuredPath, elements: Elements) -> Elements:
    """Refine the sizes of elements that bear a part."""
    target_force = path.force_seen
    for ratio in _REFINEMENTS:
        responses = path.responses(elements)
        distinct = _distinct(responses)
        elements = elements.only(distinct).refine(fit(responses[distinct], target_force), ratio, path.largest)
    return elements


def _distinct(rows: Array) -> NDArray[np.int64]:
    """Places of rows, shape (rows, n), of which none is a multiple of one before it."""
    shares = rows @ np.random.default_rng(0).standard_normal(rows.shape[1])
    shares = shares / (np.linalg.norm(rows, axis=1) + np.finfo(float).tiny)
    return np.sort(np.unique(np.round(shares, _DIGITS), return_index=True)[1])


def _learn_family(
    path: MeasuredPath, family: str, elements: Elements, laws_found: Sequence[FoundLaw]
) -> LearnedSpecimen:
    """Fit elements, and predict what had no part in the fit."""
    target_force = path.force_seen
    responses = path.responses(elements)
    distinct = _distinct(responses)
    distinct = distinct[np.abs(responses[distinct]).max(axis=1) > _UNSEEN * path.largest]
    elements, responses = elements.only(distinct), responses[distinct]
    coefficients = fit(responses, target_force)
    sizes = np.sqrt(np.mean(responses**2, axis=1) / np.mean(target_force**2))
    bears = coefficients * sizes > _LEAST_PART
    coefficients[bears] = fit(responses[bears], target_force)
    bears &= coefficients > 0.0
    fits = _fit_without_quarters(responses[bears], target_force, path.blocks)
    held_out = _held_out_misfit(responses[bears], target_force, fits)
    borne, share = elements.only(bears), coefficients[bears] * sizes[bears]
    return LearnedSpecimen(
        family=family,
        elements=borne,
        coefficients=coefficients[bears],
        held_out=held_out,
        missed=_beyond_noise(held_out, path),
        laws=tuple(law for law in laws_found if law.kind in borne.kinds[share > _GREAT_PART]),
    )


def estimate_lag(path: MeasuredPath, specimen: LearnedSpecimen, late: Array) -> StatedValue:
    """Time by which a force seems late [s], negative where it seems early, as by viscous damping.

    `late`: what a unit of lag adds to the force [N/s], shape (n,). The deviation is that of the jackknife
    over quarters, and of what the specimen's family misses of the force.
    """
    force, lag = path.force_seen, path.thin(late)
    rows = np.vstack([path.responses(specimen.elements), lag, -lag])
    is_viscous = np.isin(specimen.elements.kinds, _VISCOUS)
    power = float(lag @ lag)

    def value(coefficients: Array) -> float:
        viscous_force = coefficients[:-2][is_viscous] @ rows[:-2][is_viscous]
        return float(coefficients[-2] - coefficients[-1] + viscous_force @ lag / power)

    fits = list(_fit_without_quarters(rows, force, path.blocks))
    scatter = float(np.std([value(coefficients) for coefficients, _ in fits]))
    missed = _beyond_noise(_held_out_misfit(rows, force, fits), path)
    unclear = (_SHARE_MISSED * missed + _LEAST_MISSED) * math.sqrt(float(force @ force) / power)
    deviation = math.hypot(scatter * math.sqrt(_QUARTERS - 1.0), unclear)
    return StatedValue(value(fit(rows, force)), deviation)


def _beyond_noise(held_out: float, path: MeasuredPath) -> float:
    """Take what noise explains off what held-out parts leave unexplained, both over the force [-]."""
    return math.sqrt(max(held_out**2 - (_NOISIER * path.noisy) ** 2, 0.0))


def _fit_without_quarters(
    rows: Array, target_force: Array, blocks: NDArray[np.int64]
) -> Iterator[tuple[Array, Array]]:
    """Fit to the test without each quarter; give coefficients and the weights of samples in the fit."""
    for quarter in range(_QUARTERS):
        training_weights = (blocks % _QUARTERS != quarter).astype(np.float64)
        yield fit(rows, target_force, training_weights), training_weights


def _held_out_misfit(rows: Array, target_force: Array, fits: Iterable[tuple[Array, Array]]) -> float:
    """RMS of what quarters leave unexplained that had no part in their fit, over that of the force."""
    squares = 0.0
    for coefficients, training_weights in fits:
        residual = target_force - coefficients @ rows
        squares += float(np.sum((1.0 - training_weights) * residual**2))
    return float(np.sqrt(squares / np.sum(target_force**2)))
