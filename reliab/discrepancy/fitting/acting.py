"""Whether an effect of a model acts: beyond its uncertainty, a converter's steps, a calibration."""

import numpy as np

from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.terms import ClockOffset
from reliab.effects.backlash import Backlash
from reliab.effects.effect import Effect, LinearEffect
from reliab.effects.rate_limit import RateLimit
from reliab.effects.stroke_saturation import StrokeSaturation

_LEAST_LAG = 0.05  # samples, of clocks that differ; simulations of one model differ by a hundredth
_ROUNDING = 0.6  # of a step; rounding moves a reading by half of it, and the fitted effect follows that
_TAKEN_OVER = 0.5  # of the calibrated delay, from which a lag says most of it
_RESTING = (Backlash, StrokeSaturation)
LIMITS = (StrokeSaturation, RateLimit)
"""Effects that act where the motion goes furthest or fastest only, so that a single part may show them."""

_DELAY = "delay_s"


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
    free = problem.predictions(space, space.inherit(fit.space, fit.coordinates))
    held_prediction = problem.predictions(fit.space, fit.coordinates)
    return any(
        np.abs(held_prediction[test] - free[test]).max() > _ROUNDING * problem.steps[test]
        for test in held_prediction
    )


def takes_over_delay(candidate: Fit, smaller: Fit) -> bool:
    """Whether a model has one more effect, a lag, that says most of what was calibrated as a delay.

    It then stands in the place of a calibration, and is no further effect beside the others.
    """
    added_effects = set(candidate.space.effects) - set(smaller.space.effects)
    if len(added_effects) != 1 or not issubclass(next(iter(added_effects)), LinearEffect):
        return False
    names = [item.parameter.name for item in candidate.space.block.calibrations]
    if _DELAY not in names:
        return False
    place = names.index(_DELAY)
    delay, former_delay = (fit.space.values(fit.coordinates)[place] for fit in (candidate, smaller))
    return bool(delay < _TAKEN_OVER * former_delay)
