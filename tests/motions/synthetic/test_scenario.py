"""Scenarios: what the model takes, and how close the drawn ones are to the FEMA P-695 stations."""

from math import exp, hypot

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import VALID_RANGES, Mechanism, Scenario
from reliab.motions.synthetic.fema_p695_2009 import (
    Earthquake,
    draw_earthquake,
    draw_scenario,
    is_strong,
    rupture_length,
)
from reliab.motions.synthetic.random_stream import RandomStream
from reliab.motions.synthetic.suite import pulse_probability

_VALUES = {
    "magnitude": 7.0,
    "depth_to_top": 0.0,
    "rupture_distance": 10.0,
    "shear_wave_velocity": 360.0,
    "directivity_length": 20.0,
    "directivity_angle": 30.0,
}


def _draw(count: int) -> list[Scenario]:
    earthquakes = [draw_earthquake(RandomStream(11, i, 0)) for i in range(count)]
    return [draw_scenario(earthquake, RandomStream(11, i, 1)) for i, earthquake in enumerate(earthquakes)]


@pytest.mark.parametrize("quantity", VALID_RANGES)
@pytest.mark.parametrize("side", [0, 1])
def test_scenarios_outside_the_range_of_the_model_are_refused(quantity: str, side: int) -> None:
    limit = VALID_RANGES[quantity][side]
    beyond = limit + (1.0 if side else -1.0)
    with pytest.raises(InputError, match=quantity.replace("_", " ")):
        Scenario(mechanism=Mechanism.REVERSE, **{**_VALUES, quantity: beyond})


def test_rupture_nearer_than_its_top_is_refused() -> None:
    with pytest.raises(InputError, match="nearer to the station"):
        Scenario(mechanism=Mechanism.REVERSE, **{**_VALUES, "depth_to_top": 11.0})


def test_drawn_scenarios_are_those_of_fema_p695() -> None:
    """Moments of tables A-4 and A-6: 50 stations, 19 earthquakes."""
    scenarios = _draw(3000)
    magnitude = np.array([scenario.magnitude for scenario in scenarios])
    distance = np.array([scenario.rupture_distance for scenario in scenarios])
    velocity = np.log([scenario.shear_wave_velocity for scenario in scenarios])
    reverse = np.mean([scenario.mechanism is Mechanism.REVERSE for scenario in scenarios])
    assert (magnitude.min() >= 6.5, magnitude.max() <= 7.9) == (True, True)
    assert (magnitude.mean(), magnitude.std()) == pytest.approx((6.98, 0.40), abs=0.04)
    assert (distance.mean(), distance.std()) == pytest.approx((10.0, 6.5), abs=0.6)
    assert (np.exp(np.median(velocity)), velocity.std()) == pytest.approx((385.0, 0.43), rel=0.1)
    assert reverse == pytest.approx(0.5, abs=0.03)


def test_a_third_of_the_drawn_stations_has_a_pulse() -> None:
    """FEMA P-695 finds pulses at 14 of its 28 near-field stations, that is 28 % of all."""
    probability = np.mean([pulse_probability(scenario) for scenario in _draw(1000)])
    assert 0.2 < probability < 0.45


def test_stations_lie_around_the_rupture_at_their_distance() -> None:
    earthquake = Earthquake(
        magnitude=7.0, mechanism=Mechanism.STRIKE_SLIP, depth_to_top=0.0, length=50.0, hypocentre=0.0
    )
    for i in range(300):
        scenario = draw_scenario(earthquake, RandomStream(3, i))
        angle = np.radians(scenario.directivity_angle)
        if 1.2 < scenario.directivity_length < 50.0:
            across = scenario.directivity_length * np.tan(angle)
            assert across == pytest.approx(scenario.rupture_distance)
        elif scenario.directivity_length == 50.0:
            hypotenuse = hypot(50.0, scenario.rupture_distance)
            assert np.sin(angle) <= scenario.rupture_distance / hypotenuse + 1e-9


@pytest.mark.parametrize(
    ("mechanism", "expected"),
    [
        (Mechanism.STRIKE_SLIP, 1.0 / (1.0 + exp(0.457 + 1.26 - 0.244 * 20.0**0.5 + 0.39))),
        (Mechanism.REVERSE, 1.0 / (1.0 + exp(0.304 + 0.72 - 0.208 * 20.0**0.5 + 0.63))),
    ],
)
def test_pulse_probability_is_the_logistic_regression(mechanism: Mechanism, expected: float) -> None:
    assert pulse_probability(Scenario(mechanism=mechanism, **_VALUES)) == pytest.approx(expected)


def test_rupture_length_scatters_around_its_median() -> None:
    median = rupture_length(7.0, Mechanism.REVERSE)
    assert median == pytest.approx(10.0**1.64)
    assert rupture_length(7.0, Mechanism.REVERSE, deviation=1.0) / median == pytest.approx(10.0**0.16)


@pytest.mark.parametrize(
    ("acceleration", "duration", "strong"), [(3.0, 0.2, True), (1.9, 1.0, False), (3.0, 0.02, False)]
)
def test_strong_means_both_acceleration_and_velocity(
    acceleration: float,
    duration: float,
    strong: bool,  # noqa: FBT001 - a parameter of the test
) -> None:
    weak = np.zeros(200)
    loud = np.where(np.arange(200) * 0.01 < duration, acceleration, 0.0)
    assert is_strong(np.stack([weak, loud]), time_step=0.01) is strong
