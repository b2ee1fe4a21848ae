"""Contours of equal error and the curves fitted to them."""

import csv

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.motions.loading import load_motions
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.tracking.boundary.contour import Contour, trace_contours
from reliab.tracking.boundary.curves import Cosine, Ellipse, InscribedEllipse, Parabola
from reliab.tracking.boundary.suite_boundary import motion_contours
from reliab.tracking.indices.response_error import relative_error

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.1)


@pytest.mark.parametrize("half_width", [0.002, 0.02, 0.3])
def test_ellipse_of_known_axes_comes_back(half_width):
    (contour,) = trace_contours(
        lambda a, d, _: 0.05 * np.hypot((a - 1.0) / half_width, d / 0.003), np.array([0.05]), STRUCTURE
    )
    found = Ellipse.fit(contour)
    assert 11 <= contour.amplitude.size <= 201
    assert found.a == pytest.approx(half_width**2, rel=1e-5)
    assert found.b == pytest.approx(9.0, rel=1e-5)
    assert found.sse < 1e-6


@pytest.mark.parametrize(
    ("below", "above", "step", "first", "last"),
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
    below, above, step, first, last
):
    def error(amplitude, delay, _):
        offset = amplitude - 1.0
        return 0.05 * np.hypot(offset / np.where(offset < 0.0, below, above), delay / 0.003)

    (contour,) = trace_contours(error, np.array([0.05]), STRUCTURE)
    assert contour.amplitude == pytest.approx(1.0 + step * np.arange(first, last + 1), abs=1e-9)
    assert contour.corners == pytest.approx(np.array([[1.0 - below, 1.0 + above], [0.0, 0.0]]), rel=1e-6)
    half_width = np.where(contour.amplitude < 1.0, below, above)
    height = 0.003 * np.sqrt(1.0 - ((contour.amplitude - 1.0) / half_width) ** 2)
    assert contour.delay == pytest.approx(height, rel=1e-5)
    assert contour.outline[0].size == contour.outline[1].size == contour.amplitude.size + 2


def test_a_loop_that_has_diverged_lies_outside_every_contour():
    """Errors that are not finite count as larger than any threshold."""
    for beyond in (np.nan, np.inf):

        def error(amplitude, delay, _, beyond=beyond):
            size = np.hypot((amplitude - 1.0) / 0.01, delay / 0.003)
            return np.where(size < 1.1, 0.05 * size, beyond)

        (contour,) = trace_contours(error, np.array([0.05]), STRUCTURE)
        assert Ellipse.fit(contour).b == pytest.approx(9.0, rel=1e-4)


def test_a_loop_with_other_errors_than_the_threshold_allows_has_no_contour():
    def error(amplitude, delay, contour):
        return np.hypot(0.04 + 0.02 * contour, np.hypot(amplitude - 1.0, delay))

    first, none = trace_contours(error, np.array([0.05, 0.05]), STRUCTURE)
    assert first.delay.max() == pytest.approx(0.03, rel=1e-6)
    assert none.outline[0].size == 0


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
def test_threshold_must_be_one_that_a_test_has(threshold):
    with pytest.raises(InputError, match="must lie between"):
        trace_contours(lambda a, d, _: np.hypot(a - 1.0, d), np.array([0.05, threshold]), STRUCTURE)


def test_curves_fit_their_own_points():
    amplitude = np.linspace(0.99, 1.01, 21)
    cosine = Cosine.fit(Contour(amplitude=amplitude, delay=1.6e-3 * np.cos(118.0 * (amplitude - 1.0))))
    assert (cosine.a, cosine.b) == (pytest.approx(1.6), pytest.approx(118.0))
    parabola = Parabola.fit(Contour(amplitude=amplitude, delay=1e-3 * (1.6 - 1e4 * (amplitude - 1.0) ** 2)))
    assert (parabola.a, parabola.b) == (pytest.approx(-1e4), pytest.approx(1.6))
    np.testing.assert_allclose(parabola.delay(np.array([1.0])), 1.6e-3)


@pytest.mark.parametrize("curve", [Cosine, Ellipse, InscribedEllipse, Parabola])
def test_the_fitting_error_is_that_of_squared_delays_in_milliseconds(curve):
    """Equation (10), with each curve's delay written out from its parameters."""
    offset = np.linspace(-0.008, 0.008, 17)
    delay = 1.5 * np.sqrt(1.0 - (offset / 0.01) ** 2) + 0.02 * np.cos(900.0 * offset)
    found = curve.fit(Contour(amplitude=1.0 + offset, delay=1e-3 * delay))
    a, b = found.a, found.b
    of_curve = {
        Cosine: a * np.cos(b * offset),
        Parabola: a * offset**2 + b,
        Ellipse: np.sqrt(b - b / a * offset**2),
        InscribedEllipse: np.sqrt(b - b / a * offset**2),
    }[curve]
    assert found.n == 17
    assert found.sse == pytest.approx(np.sum((of_curve**2 - delay**2) ** 2), rel=1e-9)
    assert found.delay(1.0 + offset) == pytest.approx(1e-3 * of_curve, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("curve", [Cosine, Ellipse, InscribedEllipse, Parabola])
def test_a_contour_without_points_gives_a_curve_that_accepts_nothing(curve):
    none = curve.fit(Contour(amplitude=np.zeros(0), delay=np.zeros(0)))
    assert (none.a, none.b, none.sse, none.n) == (0.0, 0.0, 0.0, 0)
    assert np.isnan(none.delay(np.array([0.99, 1.0]))).all()


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
        found, row = Ellipse.fit(*motion_contours(loop)), rows[motion.name]
        ratios = (found.a / float(row["a"]), found.b / float(row["b"]))
        near_prototype += max(abs(ratio - 1.0) for ratio in ratios) < 0.01
        ratios = (found.a / float(row["a_pub"]), found.b / float(row["b_pub"]))
        near_print += max(abs(ratio - 1.0) for ratio in ratios) < 0.10
    assert near_prototype >= 95
    assert near_print >= 74
