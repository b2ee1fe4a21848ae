"""Whether a fitted effect acts: beyond what a converter's rounding does."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.discrepancy.fitting.screening import exceeds_rounding
from reliab.effects.registry import find_effect

BACKLASH, LAG, STOP = (find_effect(name) for name in ("backlash", "first_order_lag", "stroke_saturation"))
STEP = 0.01


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
