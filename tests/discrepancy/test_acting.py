"""Whether a fitted effect acts: beyond what a converter's rounding does, or in the place of a delay."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.discrepancy.fitting.screening import exceeds_rounding, takes_over_delay
from reliab.effects.registry import find_effect

BACKLASH, LAG, STOP = (find_effect(name) for name in ("backlash", "first_order_lag", "stroke_saturation"))
DELAY = SimpleNamespace(parameter=SimpleNamespace(name="delay_s"))
STEP = 0.01


class Places:
    """A space whose only coordinate is the delay [s]."""

    def __init__(self, effects, calibrations):
        self.effects = effects
        self.block = SimpleNamespace(calibrations=calibrations)

    @staticmethod
    def values(coordinates):
        return np.array(coordinates)


def fit_of(delay, *effects, calibrations=(DELAY,)):
    return SimpleNamespace(space=Places(effects, calibrations), coordinates=[delay])


@pytest.mark.parametrize(("delay", "instead"), [(0.004, True), (0.006, False)])
def test_lag_replaces_a_delay_it_mostly_explains(delay, instead):
    assert takes_over_delay(fit_of(delay, BACKLASH, LAG), fit_of(0.01, BACKLASH)) is instead


def test_only_a_lag_says_a_delay_and_only_where_one_is_calibrated():
    assert not takes_over_delay(fit_of(0.0, LAG, BACKLASH), fit_of(0.01, LAG))
    assert not takes_over_delay(fit_of(0.0, BACKLASH, LAG), fit_of(0.01))
    assert not takes_over_delay(
        fit_of(0.0, BACKLASH, LAG, calibrations=()), fit_of(0.01, BACKLASH, calibrations=())
    )


def search_at_stop(effect, cut, step):
    """A problem in which an effect takes something off the crest of a motion [m], read in steps."""
    block = SimpleNamespace(calibrations=(), offsets=(), removable={})
    space = SimpleNamespace(block=block, effects=(effect,))
    space.keys = tuple(f"{effect.name}.{item.name}" for item in effect.parameters)
    motion = np.sin(np.linspace(0.0, 6.0, 200))

    def predictions(of, _coordinates):
        return {0: np.clip(motion, cut - 1.0, 1.0 - cut) if of.effects else motion}

    problem = SimpleNamespace(steps={0: step}, predictions=predictions)
    return problem, SimpleNamespace(space=space, coordinates=np.zeros(1)), effect


@pytest.mark.parametrize(("cut", "exceeds"), [(0.005, False), (0.007, True)])
@pytest.mark.parametrize("effect", [STOP, BACKLASH, find_effect("command_saturation")])
def test_a_stop_cuts_off_more_than_a_converter_rounds(effect, cut, exceeds):
    assert exceeds_rounding(*search_at_stop(effect, cut, STEP)) is exceeds


def test_without_steps_and_for_other_effects_rounding_does_not_count():
    assert exceeds_rounding(*search_at_stop(STOP, 1e-6, 0.0))
    assert exceeds_rounding(*search_at_stop(LAG, 1e-6, STEP))
