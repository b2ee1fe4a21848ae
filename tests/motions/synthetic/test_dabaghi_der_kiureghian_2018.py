"""Scenarios, the published regression and the distributions of its parameters."""

from collections.abc import Callable
from dataclasses import replace
from math import exp, hypot, log, sqrt

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import integrate, stats

from reliab.motions.synthetic import dabaghi_der_kiureghian_2018 as model
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import (
    NO_PULSE,
    PULSE,
    Mechanism,
    RecordingParameters,
    Regression,
    Scenario,
    physical_parameters,
)
from reliab.motions.synthetic.fema_p695_2009 import (
    Earthquake,
    draw_earthquake,
    draw_scenario,
    is_strong,
    rupture_length,
)
from reliab.motions.synthetic.recording import RandomStream
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


def test_drawn_scenarios_lie_within_the_range_of_the_model() -> None:
    """The smallest and the largest values in the records that the model was fitted to."""
    ranges = {
        "magnitude": (5.5, 7.9),
        "depth_to_top": (0.0, 31.0),
        "rupture_distance": (0.07, 31.0),
        "shear_wave_velocity": (139.0, 2016.0),
        "directivity_length": (1.2, 135.0),
        "directivity_angle": (0.0, 90.0),
    }
    for scenario in _draw(3000):
        assert all(low <= getattr(scenario, name) <= high for name, (low, high) in ranges.items())
        assert scenario.depth_to_top <= scenario.rupture_distance


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
            normal_part = scenario.directivity_length * np.tan(angle)
            assert normal_part == pytest.approx(scenario.rupture_distance)
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


_SCENARIO = Scenario(
    magnitude=7.0,
    mechanism=Mechanism.REVERSE,
    depth_to_top=3.0,
    rupture_distance=10.0,
    shear_wave_velocity=400.0,
    directivity_length=20.0,
    directivity_angle=30.0,
)
_BOTH = pytest.mark.parametrize("regression", [NO_PULSE, PULSE], ids=["no pulse", "pulse"])


def _median(scenario: Scenario, *, pulse_like: bool = False) -> RecordingParameters:
    regression = PULSE if pulse_like else NO_PULSE
    return physical_parameters(regression.means(scenario), pulse_like=pulse_like)


@_BOTH
def test_correlations_are_positive_definite(regression: Regression) -> None:
    assert np.linalg.eigvalsh(regression.correlation).min() > 0.02
    assert regression.factor @ regression.factor.T == pytest.approx(regression.correlation, abs=1e-12)


@pytest.mark.parametrize(("regression", "count"), [(NO_PULSE, 14), (PULSE, 19)])
def test_tables_are_complete(regression: Regression, count: int) -> None:
    assert len(regression.names) == count
    assert regression.coefficients.shape == (count, 8)
    assert regression.correlation.shape == (count, count)
    assert np.all(np.diag(regression.correlation) == 1.0)


def test_arias_intensity_is_the_equation_written_out() -> None:
    distance = log(sqrt(10.0**2 + 6.0**2))
    logarithm = (
        8.09695881287823
        + 1.00609515629221 * 7.0
        - 1.39347614723327 * 0.5
        - 4.85869770683701 * distance
        + 0.472644100309933 * 7.0 * distance
        + 0.434550762616159
        - 0.862562872197509 * log(400.0)
    )
    assert _median(_SCENARIO).first.arias_intensity == pytest.approx(exp(logarithm) / 100.0, rel=1e-4)


def test_pulse_is_the_equation_written_out() -> None:
    distance = log(sqrt(10.0**2 + 6.0**2))
    velocity = 1.69862554416145 + 0.608190177030033 * 6.5 - 0.576217471720854 * distance + 0.183071013159864
    velocity += -0.0939319189357984 * log(400.0) + 0.00657091132855174 * 20.0
    period = -2.47924338395758 + 0.670395625327187 * 7.0 - 0.263957799575519
    period += -0.232548659903406 * log(400.0) + 0.00791988432530859 * 20.0
    pulse = _median(_SCENARIO, pulse_like=True).pulse
    assert pulse is not None
    assert pulse.velocity == pytest.approx(exp(velocity) / 100.0, rel=1e-4)
    assert pulse.period == pytest.approx(exp(period), rel=1e-4)


@_BOTH
@pytest.mark.parametrize(
    ("first", "second"),
    [
        ({"depth_to_top": 1.0}, {"depth_to_top": 5.0}),
        ({"shear_wave_velocity": 1100.0}, {"shear_wave_velocity": 2000.0}),
        ({"mechanism": Mechanism.STRIKE_SLIP, "depth_to_top": 0.0}, {"mechanism": Mechanism.STRIKE_SLIP}),
        ({"directivity_angle": 0.0}, {"directivity_angle": 90.0}),
    ],
    ids=[
        "depth beyond 1 km",
        "velocity beyond 1100 m/s",
        "depth of a strike-slip fault",
        "directivity angle",
    ],
)
def test_values_outside_the_regression(
    regression: Regression, first: dict[str, float], second: dict[str, float]
) -> None:
    means = [regression.means(replace(_SCENARIO, **change)) for change in (first, second)]
    assert means[0] == pytest.approx(means[1])


@pytest.mark.parametrize("pulse_like", [False, True])
def test_medians_follow_the_physics(pulse_like: bool) -> None:  # noqa: FBT001 - a parameter of the test
    def component(**change: float) -> tuple[float, float]:
        second = _median(replace(_SCENARIO, **change), pulse_like=pulse_like).second
        return second.arias_intensity, second.strong_duration

    near, far = component(rupture_distance=5.0), component(rupture_distance=25.0)
    assert near[0] > far[0]
    assert near[1] < far[1]
    small, large = component(magnitude=6.5), component(magnitude=7.5)
    assert small[0] < large[0]
    assert small[1] < large[1]
    soft, hard = component(shear_wave_velocity=200.0), component(shear_wave_velocity=800.0)
    assert soft[1] > hard[1]
    assert soft[0] >= hard[0]


def test_major_axis_is_the_stronger_one() -> None:
    parameters = _median(_SCENARIO)
    assert parameters.first.arias_intensity > parameters.second.arias_intensity


def test_median_arias_intensity_agrees_with_an_independent_prediction() -> None:
    """Within the scatter of the records, a factor of 2.7, everywhere, and within 1.5 on average."""
    ratios = [
        _mean_arias_intensity(magnitude, distance, mechanism)
        / _travasarou_2003(magnitude, distance, mechanism)
        for magnitude in (6.5, 7.0, 7.5)
        for distance in (5.0, 15.0, 30.0)
        for mechanism in Mechanism
    ]
    assert np.abs(np.log(ratios)).max() < 1.0
    assert abs(np.log(ratios).mean()) < log(1.5)


def _mean_arias_intensity(magnitude: float, distance: float, mechanism: Mechanism) -> float:
    scenario = replace(
        _SCENARIO,
        magnitude=magnitude,
        mechanism=mechanism,
        depth_to_top=0.5 if mechanism is Mechanism.REVERSE else 0.0,
        rupture_distance=distance,
    )
    medians = _median(scenario)
    return sqrt(medians.first.arias_intensity * medians.second.arias_intensity)


def _travasarou_2003(magnitude: float, distance: float, mechanism: Mechanism) -> float:
    """Median Arias intensity [m/s] on ground of class C (Travasarou, Bray & Abrahamson 2003)."""
    excess = magnitude - 6.0
    source = 2.8 - 1.981 * excess + 20.72 * log(magnitude / 6.0)
    path = -1.703 * log(sqrt(distance**2 + 8.78**2))
    site = 0.454 + 0.101 * excess
    return exp(source + path + site + (0.512 if mechanism is Mechanism.REVERSE else 0.0))


_NORMAL = st.floats(-3.5, 3.5)


@given(_NORMAL)
def test_oscillations_and_bandwidth_are_beta_distributed_and_the_phase_uniform(nu: float) -> None:
    share = stats.norm.cdf(nu)
    oscillations = stats.beta(1.30326178289206, 3.96858083951547, loc=2.0, scale=1.2).ppf(share)
    bandwidth = stats.beta(5.33551936215137, 3.82954843573707, loc=-4.7, scale=4.7).ppf(share)
    assert model.oscillations(nu) == pytest.approx(oscillations, rel=1e-5)
    assert np.log(model.bandwidth(nu)) == pytest.approx(bandwidth, abs=1e-5)
    assert model.phase(nu) == pytest.approx(2.0 * share)


def _slope_density(slope: float) -> float:
    return 4.42179588354923 * np.exp(6.40242376475815 * slope if slope < 0 else -14.2935537214223 * slope)


def test_published_slope_density_has_unit_area() -> None:
    area = integrate.quad(_slope_density, -3.5, 0.0)[0] + integrate.quad(_slope_density, 0.0, 1.5)[0]
    assert area == pytest.approx(1.0, abs=1e-12)


@given(_NORMAL)
def test_slope_inverts_the_integral_of_its_density(nu: float) -> None:
    slope = model.slope(nu)
    share = integrate.quad(_slope_density, -3.5, min(slope, 0.0))[0]
    share += integrate.quad(_slope_density, 0.0, slope)[0] if slope > 0 else 0.0
    assert share == pytest.approx(stats.norm.cdf(nu), abs=1e-6)


@pytest.mark.parametrize("transform", [model.oscillations, model.bandwidth, model.phase, model.slope])
def test_transforms_increase(transform: Callable[[float], float]) -> None:
    values = [transform(nu) for nu in np.linspace(-6.0, 6.0, 101)]
    assert np.all(np.diff(values) >= 0.0)
