"""A parameter's coordinate, bounds and derivative, where no scale is one."""

import numpy as np
import pytest

from reliab.effects.effect import Parameter, Scales

SCALES = Scales(displacement=2.0, velocity=3.0, acceleration=5.0, force=7.0, duration=11.0)
UNIT = 7.0 / 3.0**2  # of force over velocity squared


def parameter(**changed):
    scale = (("force", 1.0), ("velocity", -2.0))
    words = {"name": "c", "units": "N s²/m²", "meaning": "a coefficient", "starts": (1.0,), "scale": scale}
    return Parameter(**{**words, "lower": 0.25, "upper": 4.0, "typical": 0.5, "spread": 1.25, **changed})


POSITIVE, SIGNED = parameter(), parameter(signed=True, neutral=0.75)


@pytest.mark.parametrize("parameter", [POSITIVE, SIGNED])
@pytest.mark.parametrize("relative", [0.3, 0.75, 2.0])
def test_values_are_those_of_the_coordinate(parameter, relative):
    coordinate = parameter.coordinate(relative * UNIT, SCALES)
    assert coordinate == pytest.approx(relative - 0.75 if parameter.signed else np.log(relative))
    assert parameter.value(coordinate, SCALES) == pytest.approx(relative * UNIT)
    around = [parameter.value(coordinate + change, SCALES) for change in (-1e-5, 1e-5)]
    assert parameter.derivative(coordinate, SCALES) == pytest.approx(np.diff(around)[0] / 2e-5, rel=1e-6)


@pytest.mark.parametrize("parameter", [POSITIVE, SIGNED])
def test_bounds_and_prior_are_stated_without_a_unit(parameter):
    for bound, coordinate in zip((0.25, 4.0), parameter.coordinate_bounds, strict=True):
        assert parameter.value(coordinate, SCALES) == pytest.approx(bound * UNIT)
    mean, spread = parameter.coordinate_prior
    assert parameter.value(mean, SCALES) == pytest.approx((0.75 if parameter.signed else 0.5) * UNIT)
    assert spread == (0.5 if parameter.signed else 1.25)


def test_rounding_error_of_nothing_is_zero():
    """A step to a bound at zero leaves 1e-32, which no effect takes for a value of its parameter."""
    assert SIGNED.value(1e-17 - 0.75, SCALES) == 0.0
    assert SIGNED.value(1e-9 - 0.75, SCALES) == pytest.approx(1e-9 * UNIT)
