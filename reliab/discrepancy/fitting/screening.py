"""How much an effect promises to explain beside a fitted model, and whether one in a model acts."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from operator import itemgetter

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.segment import split_by_segment
from reliab.effects.backlash import Backlash
from reliab.effects.clock_offset import ClockOffset
from reliab.effects.effect import Effect, Role
from reliab.effects.general.periodic import Disturbance, disturbance
from reliab.effects.rate_limit import RateLimit
from reliab.effects.stroke_saturation import StrokeSaturation
from reliab.signals.noise import near_mains

_WORKERS = 2
_HIGH = 25.0  # times the noise's power, on the average of the segments
_LOWEST = 0.2  # Hz
_NEAR_ZERO = 2  # frequencies of a segment above zero that cannot be told from a drift


@dataclass(frozen=True, kw_only=True, eq=False)
class Promise:
    """How much an effect promises to explain beside a fitted model."""

    kind: type[Effect]  # The effect
    gain: float  # Gain of log-likelihood, to first order
    start: Array  # Coordinates from which to fit
    others: tuple[Array, ...] = ()  # Coordinates that promised less


def screen_effects(problem: Problem, parent: Fit, kinds: Sequence[type[Effect]], null: Fit) -> list[Promise]:
    """Rank effects by what they promise to explain beside a model.

    Beside the calibrated one, a start from the nominal rig counts, too: a calibration that has made up for an
    actuator at its limits has moved the model away from them.
    """
    sketch, noise = problem.sketch, parent.noise
    fresh = [kind for kind in kinds if kind not in parent.space.effects]
    if not fresh:
        return []
    before = sketch.whiten(parent.space, parent.coordinates, noise)

    def screen(kind: type[Effect]) -> Promise:
        space = ModelSpace(parent.space.block, (*parent.space.effects, kind))
        starts = list(space.starts(parent.space, parent.coordinates))
        residuals = np.stack([sketch.whiten(space, start, noise) for start in starts])
        gains, factors = gains_beside(parent, residuals - before)
        promising = [
            (gain, space.scale_size(start, kind, factor))
            for start, gain, factor in zip(starts, gains.tolist(), factors.tolist(), strict=True)
            if gain > 0.0 and (factor > 0.0 or kind.parameters[0].signed)
        ]
        others = tuple(start for _, start in promising)
        if parent is null:
            for start in space.starts(parent.space, np.zeros(parent.space.size)):
                after = sketch.whiten(space, start, noise)
                promising.append((0.5 * float(before @ before - after @ after), start))
        gain, start = max(promising, key=itemgetter(0), default=(0.0, np.zeros(0)))
        if not gain > 0.0:
            return Promise(kind=kind, gain=0.0, start=np.zeros(0))
        return Promise(kind=kind, gain=gain, start=start, others=others)

    with ThreadPoolExecutor(_WORKERS) as pool:
        return sorted(pool.map(screen, fresh), key=lambda promise: -promise.gain)


def gains_beside(parent: Fit, changes: Array) -> tuple[Array, Array]:
    """Gains of log-likelihood to first order of changes of a model, and the factors that reach them.

    `changes`: of the residuals, shape (changes, rows). What the parameters of the fitted model change, too,
    does not count.
    """
    own_changes = changes - (changes @ parent.basis) @ parent.basis.T
    sizes = np.maximum((own_changes**2).sum(axis=1), 1e-300)
    factors = -(own_changes @ parent.residual) / sizes
    return 0.5 * factors**2 * sizes, factors


def line_terms(problem: Problem, fit: Fit) -> tuple[type[Disturbance], ...]:
    """Make a term of the strongest line in a model's residual, if one stands out and is not mains pickup."""
    longest = max(problem.segments, key=lambda segment: segment.end - segment.begin)
    frequency = longest.frequency
    if frequency.size <= _NEAR_ZERO + 1:
        return ()
    powers = []
    for segment, rows in split_by_segment(problem.segments, fit.residual):
        real, imaginary = rows[1 : segment.bins], rows[segment.bins :]
        power = np.concatenate([rows[:1] ** 2, 0.5 * (real**2 + imaginary**2)])
        powers.append(np.interp(frequency, segment.frequency, power))
    power = np.mean(powers, axis=0)
    power[: _NEAR_ZERO + 1] = 0.0
    power[(frequency < _LOWEST) | near_mains(frequency, 0.5 * problem.block.rate)] = 0.0
    place = int(np.argmax(power))
    if power[place] < _HIGH:
        return ()
    role = Role.FORCE if problem.block.block is Block.SPECIMEN else Role.DISPLACEMENT_READING
    return (disturbance(role, float(frequency[place]), float(frequency[1])),)


_LEAST_LAG = 0.05  # samples, of clocks that differ; simulations of one model differ by a hundredth
_ROUNDING = 0.6  # of a step; rounding moves a reading by half of it, and the fitted effect follows that
_RESTING = (Backlash, StrokeSaturation)
LIMITS = (StrokeSaturation, RateLimit)
"""Effects that act where the motion goes furthest or fastest only, so that a single part may show them."""


def acts(fit: Fit, effect: type[Effect], deviations: float) -> bool:
    """Whether an effect is so many standard deviations from none, where its parameters can say so."""
    if not all(parameter.signed for parameter in effect.parameters):
        return True
    place = fit.space.places(effect)
    if effect is ClockOffset:
        lag = fit.space.values(fit.coordinates)[place]
        return bool((np.abs(lag) * fit.space.block.rate > _LEAST_LAG).all())
    neutral = fit.neutralise([effect])
    distance = np.abs(fit.space.values(fit.coordinates) - fit.space.values(neutral.coordinates))[place]
    spread = fit.space.standard_deviations(fit.coordinates, fit.covariance)[place]
    return bool((distance > deviations * spread).any())


def exceeds_rounding(problem: Problem, fit: Fit, effect: type[Effect]) -> bool:
    """Whether an effect that holds the reading still moves it by more than a converter's rounding does.

    A converter, too, holds the reading of a motion still where that turns.
    """
    if not issubclass(effect, _RESTING) or not any(problem.steps.values()):
        return True
    space = ModelSpace(fit.space.block, tuple(e for e in fit.space.effects if e is not effect))
    free = problem.predictions(space, next(space.starts(fit.space, fit.coordinates)))
    held_prediction = problem.predictions(fit.space, fit.coordinates)
    return any(
        np.abs(held_prediction[test] - free[test]).max() > _ROUNDING * problem.steps[test]
        for test in held_prediction
    )
