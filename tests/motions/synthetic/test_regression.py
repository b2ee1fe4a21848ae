"""The published regression: its tables, its covariates and what it predicts."""

from dataclasses import replace
from math import exp, log, sqrt

import numpy as np
import pytest

from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import (
    NO_PULSE,
    PULSE,
    Mechanism,
    RecordingParameters,
    Regression,
    Scenario,
    physical_parameters,
)

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
def test_what_the_regression_does_not_see(
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
    beyond = magnitude - 6.0
    source = 2.8 - 1.981 * beyond + 20.72 * log(magnitude / 6.0)
    path = -1.703 * log(sqrt(distance**2 + 8.78**2))
    site = 0.454 + 0.101 * beyond
    return exp(source + path + site + (0.512 if mechanism is Mechanism.REVERSE else 0.0))
