"""Contours of equal error, traced or read from a surface."""

import csv
from itertools import pairwise

import numpy as np
import pytest
import scipy

from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric, Side
from reliab.motions.loading import load_motions
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure, longest_lead
from reliab.tracking.boundary.contour import (
    Contour,
    ErrorSurfaces,
    furthest_lead,
    stretch_coordinate,
    trace_contours,
)
from reliab.tracking.boundary.curves import Ellipse, InscribedEllipse
from reliab.tracking.boundary.suite_boundary import motion_contours, suite_contours
from reliab.tracking.indices.response_error import relative_error

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.1)


@pytest.mark.parametrize("half_width", [0.002, 0.02, 0.3])
def test_ellipse_of_known_axes_comes_back(half_width):
    (contour,) = trace_contours(
        lambda a, d, _: 0.05 * np.hypot((a - 1.0) / half_width, d / 0.003), np.array([0.05]), STRUCTURE
    )
    result = Ellipse.fit(contour)
    assert 11 <= contour.amplitude.size <= 201
    assert result.a == pytest.approx(half_width**2, rel=1e-5)
    assert result.b == pytest.approx(9.0, rel=1e-5)
    assert result.sse < 1e-6


@pytest.mark.parametrize(
    ("lower", "upper", "step", "first", "last"),
    [
        (0.02, 0.02, 0.001, -19, 19),  # the paper's step; the tips themselves have no delay to search
        (0.0125, 0.0307, 0.001, -12, 30),
        (0.006, 0.02, 0.001, -5, 19),
        (0.0055, 0.02, 0.0005, -10, 39),
        (0.002, 0.002, 0.001 / 3, -5, 5),
        (0.0035, 0.05, 0.0005, -6, 99),
        (0.0997, 0.0997, 0.001, -99, 99),
        (0.28, 0.2, 0.003, -93, 66),
    ],
)
def test_amplitudes_step_by_a_thousandth_and_at_least_five_and_at_most_a_hundred_to_a_side(
    lower, upper, step, first, last
):
    def error(amplitude, delay, _):
        offset = amplitude - 1.0
        return 0.05 * np.hypot(offset / np.where(offset < 0.0, lower, upper), delay / 0.003)

    (contour,) = trace_contours(error, np.array([0.05]), STRUCTURE)
    assert contour.amplitude == pytest.approx(1.0 + step * np.arange(first, last + 1), abs=1e-9)
    assert contour.corners == pytest.approx(np.array([[1.0 - lower, 1.0 + upper], [0.0, 0.0]]), rel=1e-6)
    half_width = np.where(contour.amplitude < 1.0, lower, upper)
    height = 0.003 * np.sqrt(1.0 - ((contour.amplitude - 1.0) / half_width) ** 2)
    assert contour.delay == pytest.approx(height, rel=1e-5)
    assert contour.outline[0].size == contour.outline[1].size == contour.amplitude.size + 2


def test_diverged_loop_lies_outside_every_contour():
    """Errors that are not finite count as larger than any threshold."""
    for excess in (np.nan, np.inf):

        def error(amplitude, delay, _, excess=excess):
            size = np.hypot((amplitude - 1.0) / 0.01, delay / 0.003)
            return np.where(size < 1.1, 0.05 * size, excess)

        (contour,) = trace_contours(error, np.array([0.05]), STRUCTURE)
        assert Ellipse.fit(contour).b == pytest.approx(9.0, rel=1e-4)


def test_a_loop_with_other_errors_than_the_threshold_allows_has_no_contour():
    def error(amplitude, delay, contour):
        return np.hypot(0.04 + 0.02 * contour, np.hypot(amplitude - 1.0, delay))

    first, empty = trace_contours(error, np.array([0.05, 0.05]), STRUCTURE)
    assert first.delay.max() == pytest.approx(0.03, rel=1e-6)
    assert empty.outline[0].size == 0


def test_points_lie_on_the_threshold_for_both_errors():
    rng = np.random.default_rng(7)
    t = np.arange(0.0, 20.0, 0.01)
    record = rng.standard_normal(t.size) * np.exp(-(((t - 8.0) / 4.0) ** 2))
    loop = Loop(
        excitation=Excitation(acceleration=record, time_step=0.01),
        structure=Structure(frequency=1.0, damping_ratio=0.04),
    )
    for metric in Metric:
        thresholds = (0.01, 0.05, 0.2)
        for threshold, contour in zip(thresholds, motion_contours(loop, thresholds, metric), strict=True):
            error = relative_error(
                loop.deviation(loop.cells(gain=contour.amplitude, delay=contour.delay)), metric
            )
            np.testing.assert_allclose(error, threshold, rtol=1e-4)


def test_contour_is_cut_where_the_amplitude_is_out_of_all_proportion():
    (contour,) = trace_contours(
        lambda a, d, _: 0.05 * np.hypot(0.3 * (a - 1.0), d / 0.003), np.array([0.05]), STRUCTURE
    )
    assert contour.amplitude[[0, -1]] == pytest.approx(np.exp([-0.5, 0.5]), abs=0.02)
    np.testing.assert_allclose(contour.delay, 0.003 * np.sqrt(1 - (0.3 * (contour.amplitude - 1)) ** 2))


@pytest.mark.parametrize("threshold", [-0.05, 0.0, np.nan, np.inf])
def test_threshold_must_be_plausible(threshold):
    with pytest.raises(InputError, match="must lie between"):
        trace_contours(lambda a, d, _: np.hypot(a - 1.0, d), np.array([0.05, threshold]), STRUCTURE)


@pytest.mark.parametrize("curve", [Ellipse, InscribedEllipse])
def test_fitting_error_is_of_squared_delays_in_milliseconds(curve):
    """Equation (10), with the delay written out from the parameters."""
    offset = np.linspace(-0.008, 0.008, 17)
    delay = 1.5 * np.sqrt(1.0 - (offset / 0.01) ** 2) + 0.02 * np.cos(900.0 * offset)
    result = curve.fit(Contour(amplitude=1.0 + offset, delay=1e-3 * delay))
    a, b = result.a, result.b
    curve_values = np.sqrt(b - b / a * offset**2)
    assert result.n == 17
    assert result.sse == pytest.approx(np.sum((curve_values**2 - delay**2) ** 2), rel=1e-9)
    assert result.delay(1.0 + offset) == pytest.approx(1e-3 * curve_values, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("curve", [Ellipse, InscribedEllipse])
def test_empty_contour_gives_a_curve_accepting_nothing(curve):
    empty = curve.fit(Contour(amplitude=np.zeros(0), delay=np.zeros(0)))
    assert (empty.a, empty.b, empty.sse, empty.n) == (0.0, 0.0, 0.0, 0)
    assert np.isnan(empty.delay(np.array([0.99, 1.0]))).all()


def test_two_points_are_no_contour():
    with pytest.raises(InputError, match="at least 3 points"):
        Ellipse.fit(Contour(amplitude=np.ones(2), delay=np.ones(2)))


@pytest.mark.slow
def test_table_2_from_the_records(real_motions_folder, shared_folder):
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    with (shared_folder / "reference" / "table2_prototype.csv").open() as file:
        rows = {row["motion"]: row for row in csv.DictReader(file)}
    near_prototype = near_print = 0
    for motion in load_motions(real_motions_folder):
        loop = Loop(
            excitation=Excitation(acceleration=motion.acceleration, time_step=motion.time_step),
            structure=structure,
        )
        result, row = Ellipse.fit(*motion_contours(loop)), rows[motion.name]
        ratios = (result.a / float(row["a"]), result.b / float(row["b"]))
        near_prototype += max(abs(ratio - 1.0) for ratio in ratios) < 0.01
        ratios = (result.a / float(row["a_pub"]), result.b / float(row["b_pub"]))
        near_print += max(abs(ratio - 1.0) for ratio in ratios) < 0.10
    assert near_prototype >= 95
    assert near_print >= 74


GAIN = np.exp(np.array([-0.2, -0.1, -0.03, 0.0, 0.02, 0.06, 0.12]))
DELAY = np.array([-0.01, -0.004, 0.0, 0.002, 0.006, 0.015, 0.03])
FLOOR = 3e-4


def coordinates(gain, delay):
    """Linear at the perfect actuator, logarithmic around it, linear further out; written out anew."""
    x, y = np.log(gain), delay
    return np.arcsinh(x / 0.03) + x / (0.2 * 0.2), np.arcsinh(y / 0.002) + y / (0.1 * 0.03)


def cubic(gain, delay):
    """An error whose logarithm is a polynomial of third degree, which a bicubic spline gives back exactly."""
    x, y = coordinates(gain, delay)
    logarithm = (
        -6.0 + 0.3 * x - 0.2 * y + 0.05 * x * y + 0.02 * x**2 - 0.01 * y**2 - 1e-3 * x**3 + 2e-4 * y**3
    )
    return np.sqrt(np.exp(logarithm) - FLOOR**2)


def surfaces():
    gain, delay = np.meshgrid(GAIN, DELAY, indexing="ij")
    return ErrorSurfaces(GAIN, DELAY, np.stack([cubic(gain, delay), 2.0 * cubic(gain, delay)]))


def test_a_cubic_surface_comes_back_between_the_cells():
    rng = np.random.default_rng(1)
    gain, delay = np.exp(rng.uniform(-0.2, 0.12, 500)), rng.uniform(-0.01, 0.03, 500)
    error = surfaces().error(gain, delay, np.zeros(500, dtype=np.int64))
    assert error == pytest.approx(cubic(gain, delay), rel=1e-9)


def test_a_rough_surface_is_the_cubic_spline_along_both_axes_in_every_cell():
    rng = np.random.default_rng(3)
    rough = 10.0 ** rng.uniform(-2.0, 0.0, (GAIN.size, DELAY.size))
    gain, delay = np.exp(rng.uniform(-0.2, 0.12, 300)), rng.uniform(-0.01, 0.03, 300)
    x, y = coordinates(GAIN, DELAY)
    surface = ErrorSurfaces(GAIN, DELAY, rough[np.newaxis])
    gain_axis = scipy.interpolate.CubicSpline(x, np.log(rough**2 + FLOOR**2), axis=0)
    for g, d in zip(gain, delay, strict=True):
        position = coordinates(g, d)
        logarithm = scipy.interpolate.CubicSpline(y, gain_axis(position[0]))(position[1])
        expected = np.sqrt(max(np.exp(logarithm) - FLOOR**2, 0.0))
        error = surface.error(np.array([g]), np.array([d]), np.zeros(1, dtype=np.int64))
        assert error[0] == pytest.approx(expected, rel=1e-8, abs=1e-9)


def test_the_larger_side_of_the_gains_sets_the_scale():
    """Gains mirrored: the logarithm is then cubic in mirrored coordinates."""
    gain, delay = np.meshgrid(1.0 / GAIN[::-1], DELAY, indexing="ij")
    mirror = ErrorSurfaces(1.0 / GAIN[::-1], DELAY, cubic(1.0 / gain, delay)[np.newaxis])
    rng = np.random.default_rng(2)
    gain, delay = np.exp(rng.uniform(-0.2, 0.12, 200)), rng.uniform(-0.01, 0.03, 200)
    error = mirror.error(1.0 / gain, delay, np.zeros(200, dtype=np.int64))
    assert error == pytest.approx(cubic(gain, delay), rel=1e-9)


def test_every_surface_passes_through_its_cells():
    gain, delay = (grid.ravel() for grid in np.meshgrid(GAIN, DELAY, indexing="ij"))
    for surface in (0, 1):
        error = surfaces().error(gain, delay, np.full(gain.size, surface))
        assert error == pytest.approx((1 + surface) * cubic(gain, delay), rel=1e-9)


@pytest.mark.parametrize(
    ("gain", "delay", "is_inside"),
    [
        (GAIN[0], 0.0, True),
        (GAIN[-1], 0.0, True),
        (1.0, DELAY[0], True),
        (1.0, DELAY[-1], True),
        (0.999 * GAIN[0], 0.0, False),
        (1.001 * GAIN[-1], 0.0, False),
        (1.0, 1.001 * DELAY[0], False),
        (1.0, 1.001 * DELAY[-1], False),
    ],
)
def test_beyond_the_grid_nothing_is_said(gain, delay, is_inside):
    error = surfaces().error(np.array([gain]), np.array([delay]), np.array([0]))
    assert bool(np.isfinite(error[0])) == is_inside


def test_errors_without_bound_and_without_value_count_as_a_thousand():
    error = np.full((1, GAIN.size, DELAY.size), np.inf)
    error[0, ::2] = np.nan
    error[0, 1::3] = 1e9
    result = ErrorSurfaces(GAIN, DELAY, error).error(
        GAIN, np.zeros(GAIN.size), np.zeros(GAIN.size, dtype=int)
    )
    assert result == pytest.approx(1e3)


def test_the_perfect_actuator_has_no_error():
    gain, delay = np.meshgrid(GAIN, DELAY, indexing="ij")
    error = np.hypot(np.log(gain), delay / 0.1)[np.newaxis]
    result = ErrorSurfaces(GAIN, DELAY, error).error(np.ones(1), np.zeros(1), np.zeros(1, dtype=np.int64))
    assert result == pytest.approx(0.0, abs=1e-6)


def test_the_coordinate_is_odd_and_linear_near_and_far():
    assert stretch_coordinate(np.array([-0.3]), 0.1, 2.0) == pytest.approx(-np.arcsinh(3.0) - 0.15)
    assert stretch_coordinate(np.array([1e-6]), 0.1, 2.0) == pytest.approx(1e-6 * (1 / 0.1 + 1 / 2.0))


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
    separate = []
    for threshold in (0.02, 0.005, 0.00125, 0.0003):
        lag, lead = (Ellipse.fit(item) for item in both_sides(loop, threshold))
        separate.append(np.log([lead.b / lag.b, lead.a / lag.a]))
    assert (separate[0] > 0.05).all()
    for wide, narrow in pairwise(separate):
        assert (np.abs(narrow) < 0.45 * np.abs(wide)).all()
    assert np.abs(separate[-1]).max() < 0.01


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
        is_inside = InscribedEllipse.fit(contour)
        tolerance = 2e-3 if metric is Metric.RMS else 1e-2
        assert edge_errors(loop, is_inside, side, metric).max() <= threshold * (1.0 + tolerance)
        assert edge_errors(loop, is_inside, side, metric, (0.3, 0.7, 0.95)).max() < threshold
        # and it is not smaller than it must be
        assert edge_errors(loop, is_inside, side, metric).max() >= 0.99 * threshold


def test_fitted_ellipse_does_reach_outside(loop):
    lag, _ = both_sides(loop, 0.2)
    assert edge_errors(loop, Ellipse.fit(lag), Side.LAG, Metric.RMS).max() > 0.2 * 1.05


def test_inscribed_ellipse_is_the_largest_of_all():
    """Against a search over all shapes, on boundaries that no ellipse describes."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        lower, upper = rng.uniform(0.005, 0.02, 2)
        offset = np.append(np.linspace(-lower, 0.0, 20, endpoint=False), np.linspace(0.0, upper, 21))
        height = np.sqrt(np.maximum(1.0 - (offset / np.where(offset < 0.0, lower, upper)) ** 2, 0.0))
        bent = height * (1.0 + 0.3 * rng.standard_normal() * offset / offset[-1])
        delay = 1e-3 * np.maximum(bent + 0.02 * rng.standard_normal(41), 0.0) * rng.uniform(0.5, 3.0)
        boundary = Contour(amplitude=1.0 + offset, delay=delay)
        is_inside = InscribedEllipse.fit(boundary)
        u, v = offset**2, (1e3 * delay) ** 2
        assert (u / is_inside.a + v / is_inside.b >= 1.0 - 1e-9).all()
        ratio = np.geomspace(1e-4, 1e4, 20_001) * v.max() / u.max()
        b = np.min(v + ratio[:, np.newaxis] * u, axis=1)
        largest = (b**2 / ratio)[b / ratio <= u[[0, -1]].min() * (1 + 1e-12)].max()
        assert is_inside.a * is_inside.b >= largest * (1.0 - 1e-9)
        assert is_inside.a <= u[[0, -1]].min() * (1 + 1e-12)


def test_true_ellipse_is_inscribed_in_itself():
    angle = np.linspace(0.0, np.pi, 41)
    for side in Side:
        circle = Contour(amplitude=1.0 + 0.01 * np.cos(angle), delay=side.sign * 0.002 * np.sin(angle))
        result = InscribedEllipse.fit(circle)
        assert (result.a, result.b) == (pytest.approx(1e-4), pytest.approx(4.0))


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
    is_cut = lead.corners[1] < 0.0
    assert is_cut.any()
    np.testing.assert_allclose(lead.corners[1][is_cut], -furthest)
    assert (np.abs(lead.corners[0][is_cut] - 1.0) <= 0.006 + 1e-9).all()
    is_inside = InscribedEllipse.fit(lead)
    assert np.sqrt(is_inside.b) <= 1e3 * furthest * (1 + 1e-9)


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
            result = both_sides(Loop(excitation=excitation, structure=structure), 0.05)
            lag, lead = (float(np.interp(1.0, item.amplitude, np.abs(item.delay))) for item in result)
            ratios.append(lead / lag)
        assert np.median(ratios) == pytest.approx(expected, rel=0.12)
        assert np.min(ratios) > 1.0


LEVELS, SIDES = (0.05, 0.05, 0.15), (Side.LAG, Side.LEAD, Side.LAG)


def loops_under(motions, structure, window=(0.0, -1.0), engine=Engine.AUTOMATIC):
    return [
        Loop(
            excitation=Excitation(acceleration=m.acceleration, time_step=m.time_step, window=window),
            structure=structure,
            engine=engine,
        )
        for m in motions
    ]


def assert_same(loops, tolerance):
    joint = suite_contours(loops, LEVELS, SIDES)
    for loop, contours in zip(loops, joint, strict=True):
        for separate, contour in zip(motion_contours(loop, LEVELS, side=SIDES), contours, strict=True):
            np.testing.assert_allclose(contour.amplitude, separate.amplitude, rtol=tolerance)
            np.testing.assert_allclose(
                contour.delay,
                separate.delay,
                rtol=tolerance,
                atol=tolerance * np.abs(separate.delay).max(initial=0.0),
            )


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("frequency", "xi"), [(1.0, 0.02), (2.0, 0.05)])
def test_contours_are_those_of_each_motion(frequency, xi):
    motions = load_motions("synthetic")[:2]
    assert_same(loops_under(motions, Structure(frequency=frequency, damping_ratio=xi)), 2e-4)


def test_a_suite_may_hold_one_motion():
    assert_same(
        loops_under(load_motions("synthetic")[3:4], Structure(frequency=1.0, damping_ratio=0.05)), 2e-4
    )


@pytest.mark.slow
def test_contours_of_short_windows_and_of_a_chosen_engine_are_those_of_each_motion():
    motions = load_motions("synthetic")[:2]
    structure = Structure(frequency=1.0, damping_ratio=0.03)
    assert_same(loops_under(motions, structure, window=(4.0, 9.0)), 2e-4)
    late = suite_contours(loops_under(motions, structure, engine=Engine.DELAY), LEVELS[:1], SIDES[:1])
    assert all(contours[0].amplitude.size >= 11 for contours in late)


@pytest.mark.slow
def test_contours_are_those_of_each_real_motion(real_motions_folder):
    motions = load_motions(real_motions_folder)
    small_sample = [motions[k] for k in range(0, len(motions), len(motions) // 4)]
    assert_same(loops_under(small_sample, Structure(frequency=1.0, damping_ratio=0.05)), 2e-4)
