# mypy: disable-error-code="attr-defined"
"""Panels end where their data do: margins, rows of their own, and what the frame would cut."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text

from reliab.report.figures import discrepancy
from reliab.report.kinds.assessment.frame import amplitude_and_delay_over_frequency
from reliab.report.kinds.criterion.result import criterion_surfaces
from reliab.report.kinds.rig_report import rig_over_time
from reliab.report.sections import coverage_by_frequency
from reliab.tracking.indices.tracking import TrackingOverFrequency


def rates_of(**levels):
    rows = [
        {"candidate": name, "f": f, "rate": level, "low": level - 0.02, "high": level + 0.02}
        for name, level in levels.items()
        for f in (0.5, 2.0)
    ]
    return pd.DataFrame(rows)


@pytest.mark.parametrize(("rate", "panels"), [(0.38, 2), (0.42, 1)])
def test_a_criterion_is_far_off_at_four_fifths_of_its_promise(rate, panels):
    figure = coverage_by_frequency(rates_of(ours=0.5, other=rate), confidence=0.5)
    assert len(figure.axes) == panels


def test_containment_has_a_margin_but_no_more_than_there_is():
    figure = coverage_by_frequency(rates_of(ours=0.97, none=0.03), confidence=0.9)
    upper, lower = (place.get_ylim() for place in figure.axes)
    assert upper == pytest.approx((95.0 - 0.06 * 4.0, 99.0 + 0.06 * 4.0))
    margin = 0.06 * 4.0 + 1.0
    assert lower == pytest.approx((1.0 - margin, 5.0 + margin))
    wide = coverage_by_frequency(rates_of(ours=0.98, other=0.4), confidence=0.45).axes[0].get_ylim()
    assert wide == pytest.approx((38.0 - 0.06 * 62.0, 100.0 + 0.06 * 62.0))


def test_constant_tracking_has_some_height():
    f, ones = np.linspace(0.5, 5.0, 10), np.ones(10)
    tracking = TrackingOverFrequency(
        frequency=f,
        amplitude=1.2 * ones,
        delay=0.0 * ones,
        amplitude_deviation=0.01 * ones,
        delay_deviation=1e-4 * ones,
        coherence=ones,
    )
    figure = amplitude_and_delay_over_frequency(tracking, amplitude=1.2, delay=0.0, modes=[])
    gain, delay = (place.get_ylim() for place in figure.axes)
    assert gain == pytest.approx((20.0 - 0.25 * 0.4, 20.0 + 0.25 * 0.4))
    assert delay == pytest.approx((-0.25e-3, 0.25e-3))


def test_levels_cut_by_the_frame_have_no_number():
    """Lines along an edge of the frame are there, their numbers are not."""
    f, xi = np.geomspace(0.5, 4.0, 12), np.geomspace(0.01, 0.1, 9)
    amplitude = np.broadcast_to(f[:, None], (12, 9))
    edge = np.broadcast_to(
        1.99 + 0.02 * (np.arange(12) > 0)[:, None] + 1e-3 * np.arange(12)[:, None], (12, 9)
    )
    nodes = (np.array([0.5, 4.0]), np.array([0.01, 0.1]))
    left, right = criterion_surfaces(f, xi, edge, amplitude, grid_nodes=nodes).axes
    for place in (left, right):
        transform = place.transData + place.transAxes.inverted()
        for text in place.findobj(Text):
            if text in place.texts:
                x, y = transform.transform(text.get_position())
                assert min(x, 1.0 - x, y, 1.0 - y) > 0.01
    levels = {float(text.get_text()) for text in right.texts}
    assert 2.0 in levels
    assert not left.texts


COMING = {
    "A": {"low": 0.5, "median": 1.0, "high": 1.3},
    "d_ms": {"low": 1.5, "median": 2.0, "high": 2.2},
    "remainder": {"low": 0.001, "median": 0.02, "high": 0.03},
    "rms": {"low": 0.002, "median": 0.04, "high": 0.06},
}


def test_panels_of_a_rig_hold_its_tests_the_next_one_and_the_threshold():
    count = 8
    gain, delay = 1.0 + 0.01 * np.arange(count), np.full(count, 3.0)
    noise, error = np.log(np.linspace(0.01, 0.02, count)), np.linspace(0.03, 0.05, count)
    band = (np.full(count, -5.0), np.full(count, -3.0))
    chart = SimpleNamespace(
        values={"gain": gain, "delay": delay, "noise": noise},
        bands={"gain": (gain - 0.1, gain + 0.1), "delay": (delay - 1.0, delay + 1.0), "noise": band},
        segments=np.zeros(count, int),
        changes=(SimpleNamespace(noticed=4, confirmed=True), SimpleNamespace(noticed=6, confirmed=False)),
    )
    columns = {"rms": error, "peak_mm": np.full(count, 20.0)}
    rows = [{"reliable": place != 2, "peak_mm": 20.0} for place in range(count)]
    table = SimpleNamespace(numbers=columns.__getitem__, rows=rows)
    panels = rig_over_time(table, chart, COMING, 0.08).axes
    reach = np.ptp(np.quantile(gain, [0.01, 0.99]))
    assert panels[0].get_ylim() == pytest.approx((0.5, np.quantile(gain, 0.99) + 0.6 * reach))
    assert panels[1].get_ylim() == pytest.approx((1.5, 3.0 + 0.6 * 3e-3))
    low, high = np.quantile(100.0 * np.exp(noise), [0.01, 0.99])
    assert panels[2].get_ylim() == pytest.approx((0.1, high + 0.6 * (high - low)))
    assert panels[3].get_ylim() == pytest.approx((0.2, 8.8))
    for place, (name, scale) in zip(
        panels, {"A": 1.0, "d_ms": 1.0, "remainder": 100.0, "rms": 100.0}.items(), strict=True
    ):
        (ahead,) = [row for row in place.collections if row.get_label() == "next test, 90 %"]
        ends = ahead.get_segments()[0]
        np.testing.assert_allclose(ends, [[9.0, scale * COMING[name][end]] for end in ("low", "high")])
        tests = {row.get_label(): row.get_xdata() for row in place.lines}
        np.testing.assert_array_equal(tests["reliable test"], [1, 2, 4, 5, 6, 7, 8])
        np.testing.assert_array_equal(tests["other test"], [3])
        assert list(tests["change noticed"]) == [5, 5]
        assert list(tests["not confirmed by the next tests"]) == [7, 7]


def test_a_residual_of_nothing_has_a_floor():
    nothing = np.zeros(2048)
    figure = discrepancy.discrepancy_time_frequency(
        nothing, nothing, density=np.ones(65), rate=128.0, highest=40.0
    )
    drawing = np.asarray(figure.axes[0].collections[0].get_array())
    np.testing.assert_allclose(drawing, -120.0)
