"""Lags and leads: two sides of a boundary that are not alike, and the ellipses inside them."""

from itertools import pairwise

import numpy as np
import pytest

from reliab.core.vocabulary import Metric, Side
from reliab.motions.loading import load_motions
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.stability import longest_lead
from reliab.structures.structure import Structure
from reliab.tracking.boundary.contour import Contour, furthest_lead, trace_contours
from reliab.tracking.boundary.curves import Ellipse, InscribedEllipse
from reliab.tracking.boundary.suite_boundary import motion_contours
from reliab.tracking.indices.response_error import relative_error

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.1)


@pytest.fixture(scope="module")
def loop():
    rng = np.random.default_rng(7)
    t = np.arange(0.0, 20.0, 0.01)
    record = rng.standard_normal(t.size) * np.exp(-(((t - 8.0) / 4.0) ** 2))
    return Loop(
        excitation=Excitation(acceleration=record, time_step=0.01),
        structure=Structure(frequency=1.0, damping_ratio=0.04),
    )


def both_sides(loop, threshold, metric=Metric.RMS):
    return motion_contours(loop, (threshold,) * 2, metric, side=tuple(Side))


def edge_errors(loop, ellipse, side, metric, shares=(1.0,)):
    angle = np.linspace(0.0, np.pi, 61)
    share = np.asarray(shares)[:, np.newaxis]
    amplitude = 1.0 + share * np.sqrt(ellipse.a) * np.cos(angle)
    delay = side.sign * share * 1e-3 * np.sqrt(ellipse.b) * np.sin(angle)
    return relative_error(loop.deviation(loop.cells(gain=amplitude, delay=delay)), metric)


def test_sides_meet_as_the_threshold_vanishes(loop):
    """To first order an error does not know the sign of the delay."""
    apart = []
    for threshold in (0.02, 0.005, 0.00125, 0.0003):
        lag, lead = (Ellipse.fit(each) for each in both_sides(loop, threshold))
        apart.append(np.log([lead.b / lag.b, lead.a / lag.a]))
    assert (apart[0] > 0.05).all()
    for wide, narrow in pairwise(apart):
        assert (np.abs(narrow) < 0.45 * np.abs(wide)).all()
    assert np.abs(apart[-1]).max() < 0.01


def test_points_of_both_sides_lie_on_the_threshold(loop):
    for metric in Metric:
        for side, contour in zip(Side, both_sides(loop, 0.05, metric), strict=True):
            assert (np.sign(contour.delay) == side.sign).all()
            cells = loop.cells(gain=contour.amplitude, delay=contour.delay)
            np.testing.assert_allclose(relative_error(loop.deviation(cells), metric), 0.05, rtol=1e-4)


@pytest.mark.default_cases(2)
@pytest.mark.parametrize("metric", list(Metric))
@pytest.mark.parametrize("threshold", [0.01, 0.05, 0.2])
def test_error_inside_the_inscribed_ellipse_is_below_the_threshold(loop, metric, threshold):
    for side, contour in zip(Side, both_sides(loop, threshold, metric), strict=True):
        inside = InscribedEllipse.fit(contour)
        tolerance = 2e-3 if metric is Metric.RMS else 1e-2
        assert edge_errors(loop, inside, side, metric).max() <= threshold * (1.0 + tolerance)
        assert edge_errors(loop, inside, side, metric, (0.3, 0.7, 0.95)).max() < threshold
        # and it is not smaller than it must be
        assert edge_errors(loop, inside, side, metric).max() >= 0.99 * threshold


def test_fitted_ellipse_does_reach_outside(loop):
    lag, _ = both_sides(loop, 0.2)
    assert edge_errors(loop, Ellipse.fit(lag), Side.LAG, Metric.RMS).max() > 0.2 * 1.05


def test_inscribed_ellipse_is_the_largest_of_all():
    """Against a search over all shapes, on boundaries that no ellipse describes."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        below, above = rng.uniform(0.005, 0.02, 2)
        offset = np.append(np.linspace(-below, 0.0, 20, endpoint=False), np.linspace(0.0, above, 21))
        height = np.sqrt(np.maximum(1.0 - (offset / np.where(offset < 0.0, below, above)) ** 2, 0.0))
        bent = height * (1.0 + 0.3 * rng.standard_normal() * offset / offset[-1])
        delay = 1e-3 * np.maximum(bent + 0.02 * rng.standard_normal(41), 0.0) * rng.uniform(0.5, 3.0)
        boundary = Contour(amplitude=1.0 + offset, delay=delay)
        inside = InscribedEllipse.fit(boundary)
        u, v = offset**2, (1e3 * delay) ** 2
        assert (u / inside.a + v / inside.b >= 1.0 - 1e-9).all()
        ratio = np.geomspace(1e-4, 1e4, 20_001) * v.max() / u.max()
        b = np.min(v + ratio[:, np.newaxis] * u, axis=1)
        largest = (b**2 / ratio)[b / ratio <= u[[0, -1]].min() * (1 + 1e-12)].max()
        assert inside.a * inside.b >= largest * (1.0 - 1e-9)
        assert inside.a <= u[[0, -1]].min() * (1 + 1e-12)


def test_true_ellipse_is_inscribed_in_itself():
    angle = np.linspace(0.0, np.pi, 41)
    for side in Side:
        circle = Contour(amplitude=1.0 + 0.01 * np.cos(angle), delay=side.sign * 0.002 * np.sin(angle))
        found = InscribedEllipse.fit(circle)
        assert (found.a, found.b) == (pytest.approx(1e-4), pytest.approx(4.0))


def test_leads_are_searched_up_to_seven_decay_lengths_or_a_quarter_of_the_period():
    light, heavy = (Structure(frequency=2.0, damping_ratio=xi) for xi in (0.05, 0.4))
    assert furthest_lead(light, np.array(1.0)) == pytest.approx(7.0 * 0.05 / (4.0 * np.pi))
    assert furthest_lead(heavy, np.array(1.0)) == pytest.approx(longest_lead(heavy, np.array(1.0)))
    assert furthest_lead(heavy, np.array(1.0)) < 7.0 * 0.4 / (4.0 * np.pi)


def test_open_side_says_where_it_was_left():
    """No lead at all reaches the threshold near A = 1."""
    furthest = float(furthest_lead(STRUCTURE, np.array(1.0)))

    def error(amplitude, delay, _):
        return 0.05 * np.hypot(
            (amplitude - 1.0) / 0.01, np.where(delay < 0.0, 0.8 * delay / furthest, delay / 0.003)
        )

    lag, lead = trace_contours(error, np.array([0.05, 0.05]), STRUCTURE, side=tuple(Side))
    assert lag.corners.shape == (2, 2)
    left = lead.corners[1] < 0.0
    assert left.any()
    np.testing.assert_allclose(lead.corners[1][left], -furthest)
    assert (np.abs(lead.corners[0][left] - 1.0) <= 0.006 + 1e-9).all()
    inside = InscribedEllipse.fit(lead)
    assert np.sqrt(inside.b) <= 1e3 * furthest * (1 + 1e-9)


def test_leads_are_cut_where_they_are_no_longer_searched_at_every_amplitude():
    """With much damping the longest lead of all depends on the amplitude."""
    heavy = Structure(frequency=2.0, damping_ratio=0.4)

    def error(amplitude, _delay, _owner):
        return 0.05 * np.abs(amplitude - 1.0) / 0.01

    (lead,) = trace_contours(error, np.array([0.05]), heavy, side=(Side.LEAD,))
    amplitude, delay = lead.corners[:, lead.corners[1] < 0.0]
    assert amplitude.size > 10
    np.testing.assert_allclose(-delay, furthest_lead(heavy, amplitude))
    assert np.ptp(delay) > 1e-3 * np.abs(delay).max()


@pytest.mark.slow
def test_tolerable_leads_of_the_real_records_are_longer_than_lags(real_motions_folder):
    """At 5 %, 1.24 to 1.61 times in the median of each structure."""
    motions = load_motions(real_motions_folder)[::5]
    for f, xi, expected in ((0.25, 0.02, 1.24), (2.0, 0.1, 1.8), (1.0, 0.05, 1.55)):
        structure, ratios = Structure(frequency=f, damping_ratio=xi), []
        for motion in motions:
            excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
            found = both_sides(Loop(excitation=excitation, structure=structure), 0.05)
            lag, lead = (float(np.interp(1.0, each.amplitude, np.abs(each.delay))) for each in found)
            ratios.append(lead / lag)
        assert np.median(ratios) == pytest.approx(expected, rel=0.12)
        assert np.min(ratios) > 1.0
