"""The modulating function has the intensity and the durations that it was fitted to."""

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import ComponentParameters
from reliab.motions.synthetic.recording import Modulation, fit_modulation

_SHAPES = st.builds(
    Modulation,
    peak_time=st.floats(0.5, 40.0),
    peak_share=st.floats(0.06, 0.94),
    growth=st.floats(1.0, 20.0),
    arias_intensity=st.floats(0.01, 20.0),
)


def _component(*, onset: float, rise: float, end: float, arias_intensity: float = 1.0) -> ComponentParameters:
    return ComponentParameters(
        arias_intensity=arias_intensity,
        strong_duration=end - onset,
        onset_duration=onset,
        rise_duration=rise,
        frequency=4.0,
        frequency_slope=0.0,
        bandwidth=0.2,
    )


def _durations(shape: Modulation) -> list[float]:
    return [shape.time_of_share(share) for share in (0.05, 0.30, 0.95)]


@given(_SHAPES)
def test_integral_of_the_square_gives_the_intensity_and_its_shares(shape: Modulation) -> None:
    times = np.linspace(0.0, shape.peak_time + 25.0 * shape.decay_time, 400_001)
    density = np.pi / (2.0 * STANDARD_GRAVITY) * shape(times) ** 2
    arrived = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))]) * times[1]
    assert arrived[-1] == pytest.approx(shape.arias_intensity, rel=1e-3)
    for share in (0.01, 0.05, 0.30, 0.75, 0.95):
        at = np.interp(shape.time_of_share(share), times, arrived)
        assert at == pytest.approx(share * shape.arias_intensity, abs=1e-3 * shape.arias_intensity)


@given(_SHAPES)
def test_fit_finds_a_function_from_its_durations(shape: Modulation) -> None:
    onset, rise, end = _durations(shape)
    fitted = fit_modulation(
        _component(onset=onset, rise=rise, end=end, arias_intensity=shape.arias_intensity)
    )
    assert _durations(fitted) == pytest.approx([onset, rise, end], rel=1e-6)
    times = np.linspace(0.0, 2.0 * end, 50)[1:]
    assert fitted(times) == pytest.approx(shape(times), rel=1e-3, abs=1e-3 * shape(times).max())


@given(st.floats(0.3, 20.0), st.floats(0.01, 1.2), st.floats(1.5, 18.0))
def test_onset_and_strong_duration_are_kept_whatever_the_rise(
    onset: float, rise: float, ratio: float
) -> None:
    """Also where the three durations do not fit together, as in a D0-30 before D0-5."""
    end = ratio * onset
    fitted = fit_modulation(_component(onset=onset, rise=rise * end, end=end))
    first, _, last = _durations(fitted)
    assert (first, last) == pytest.approx((onset, end), rel=1e-9)
    assert fitted.growth >= 1.0
    assert 0.05 <= fitted.peak_share <= 0.95


@given(st.floats(0.3, 20.0), st.floats(1.5, 18.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_later_rise_gives_a_later_rise(onset: float, ratio: float, one: float, other: float) -> None:
    assume(one < other)
    end = ratio * onset
    early, late = (
        fit_modulation(_component(onset=onset, rise=onset + share * (end - onset), end=end))
        for share in (one, other)
    )
    assert _durations(early)[1] <= _durations(late)[1] + 1e-9


def test_total_duration_is_kept_where_the_onset_is_too_early() -> None:
    fitted = fit_modulation(_component(onset=0.05, rise=8.0, end=30.0))
    assert fitted.growth == 1.0
    assert fitted.time_of_share(0.95) == pytest.approx(30.0)
