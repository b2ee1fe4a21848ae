"""Whether an effect of a model acts: beyond its uncertainty, a converter's steps, a calibration."""

import numpy as np

from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.terms.clock_offset import ClockOffset
from reliab.effects.backlash import Backlash
from reliab.effects.effect import Effect, LinearEffect
from reliab.effects.stroke_saturation import StrokeSaturation

_LEAST_LAG = 0.05  # samples, of clocks that differ; simulations of one model differ by a hundredth
_ROUNDED = 0.6  # of a step; rounding moves a reading by half of it, and the fitted effect follows that
_TAKEN_OVER = 0.5  # of the calibrated delay, from which a lag says most of it
_RESTING = (Backlash, StrokeSaturation)
_DELAY = "delay_s"


def acts(fitted: Fit, effect: type[Effect], deviations: float) -> bool:
    """Whether an effect is so many standard deviations from none, where its parameters can say so."""
    if not all(parameter.signed for parameter in effect.parameters):
        return True
    place = fitted.space.places(effect)
    if effect is ClockOffset:
        lag = fitted.space.values(fitted.coordinates)[place]
        return bool((np.abs(lag) * fitted.space.block.rate > _LEAST_LAG).all())
    none = fitted.coordinates.copy()
    none[place] = 0.0
    distance = np.abs(fitted.space.values(fitted.coordinates) - fitted.space.values(none))[place]
    spread = fitted.space.standard_deviations(fitted.coordinates, fitted.covariance)[place]
    return bool((distance > deviations * spread).any())


def exceeds_rounding(problem: Problem, fitted: Fit, effect: type[Effect]) -> bool:
    """Whether an effect that holds the reading still moves it by more than a converter's rounding does.

    A converter, too, holds the reading of a motion still where that turns.
    """
    if not issubclass(effect, _RESTING) or not any(problem.steps.values()):
        return True
    space = ModelSpace(fitted.space.block, tuple(e for e in fitted.space.effects if e is not effect))
    free = problem.predictions(space, space.inherited(fitted.space, fitted.coordinates))
    held = problem.predictions(fitted.space, fitted.coordinates)
    return any(np.abs(held[test] - free[test]).max() > _ROUNDED * problem.steps[test] for test in held)


def takes_over_delay(candidate: Fit, smaller: Fit) -> bool:
    """Whether a model has one more effect, a lag, that says most of what was calibrated as a delay.

    It then stands in the place of a calibration, and is no further effect beside the others.
    """
    added = set(candidate.space.effects) - set(smaller.space.effects)
    if len(added) != 1 or not issubclass(next(iter(added)), LinearEffect):
        return False
    names = [item.parameter.name for item in candidate.space.block.calibrations]
    if _DELAY not in names:
        return False
    place = names.index(_DELAY)
    delay, former = (fit.space.values(fit.coordinates)[place] for fit in (candidate, smaller))
    return bool(delay < _TAKEN_OVER * former)
