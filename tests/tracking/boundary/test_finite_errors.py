"""Boundaries of finite errors and of cut records."""

import numpy as np
import pytest

from reliab.core.vocabulary import Side
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.tracking.boundary.finite_errors import (
    DIRECTIONS,
    predict_ellipse,
    ratio_of_delays,
    ratios_of_cut_record,
    scales_of_contour,
)
from reliab.tracking.boundary.first_order import exact_response, first_order_ellipse
from reliab.tracking.boundary.suite_boundary import motion_contours


@pytest.fixture(scope="module")
def steady():
    """A long record of white noise, and a structure."""
    noise = np.random.default_rng(11).normal(size=20_000)
    return Excitation(acceleration=noise, time_step=0.01), Structure(frequency=1.0, damping_ratio=0.03)


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("side", list(Side))
@pytest.mark.parametrize("threshold", [0.02, 0.05])
def test_a_steady_response_predicts_its_boundary(steady, side, threshold):
    """Within a tenth in each direction, where small errors alone are a fifth to a half off."""
    excitation, structure = steady
    response = first_order_ellipse(excitation, structure)
    loop = Loop(excitation=excitation, structure=structure)
    (contour,) = motion_contours(loop, [threshold], side=side)
    towards = scales_of_contour(contour, *predict_ellipse(response, structure, threshold, side))[1:]
    small = scales_of_contour(contour, *response.parameters(threshold))[1:]
    middle = DIRECTIONS.size // 2  # a delay alone
    assert abs(np.log(towards[middle])) < 0.35 * abs(np.log(small[middle]))
    assert abs(np.log(towards)).max() < 0.25


def test_a_delay_ends_at_the_critical_one():
    size = np.geomspace(0.01, 1e4, 50)
    delay = size * ratio_of_delays(size, Side.LAG)
    assert (np.diff(delay) > 0.0).all()
    assert delay[-1] == pytest.approx(2.0, rel=1e-3)


def test_the_ratio_solves_its_equation():
    size = np.array([0.1, 0.7, 1.9])
    for side in Side:
        delay = size * ratio_of_delays(size, side)
        left_side = size**2 * (1.0 - side.sign * delay / 2.0) * (1.0 - side.sign * delay / 4.0)
        assert left_side == pytest.approx(delay**2, rel=1e-12)


def test_no_boundary_has_no_multiple():
    assert np.isnan(scales_of_contour(None, 1.0, 1.0)).all()


STEP = 0.01


@pytest.mark.parametrize(("f", "xi", "share"), [(1.0, 0.05, 1.0), (2.0, 0.02, 0.5), (0.5, 0.1, 1.0)])
def test_ratio_is_of_the_ellipses_of_both_records(f, xi, share):
    """The ellipse of the first seconds as a record of its own, from its spectrum, over that of the whole."""
    rng = np.random.default_rng(4)
    t = np.arange(0.0, 40.0, STEP)
    record = rng.normal(size=t.size) * np.exp(-(((t - 12.0) / 6.0) ** 2))
    structure = Structure(frequency=f, damping_ratio=xi, experimental_fraction=share)
    complete, cut = (
        first_order_ellipse(Excitation(acceleration=part, time_step=STEP), structure)
        for part in (record, record[: round(20.0 / STEP) + 1])
    )
    response = exact_response(record, STEP, structure)
    (ratios,) = ratios_of_cut_record(response, STEP, structure, 0.0, (20.0,))
    assert ratios == pytest.approx([cut.amplitude / complete.amplitude, cut.delay / complete.delay], rel=0.01)


def test_quiet_time_before_the_onset_is_cut_first():
    quiet, structure = 20.0, Structure(frequency=1.0, damping_ratio=0.05)
    t = np.arange(0.0, 20.0, STEP)
    shaking = np.sin(7.0 * t) * np.exp(-(((t - 6.0) / 3.0) ** 2))
    late = np.concatenate([np.zeros(round(quiet / STEP)), shaking])
    (ratios,) = ratios_of_cut_record(
        exact_response(late, STEP, structure), STEP, structure, quiet, (20.0 - STEP,)
    )
    assert ratios == pytest.approx([0.5, 0.5], rel=0.01)  # nothing but half of the length is lost
