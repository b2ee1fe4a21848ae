"""Boundaries that a response predicts, beside boundaries that are traced by the loop."""

import numpy as np
import pytest

from reliab.core.vocabulary import Side
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.tracking.boundary.finite_errors import (
    DIRECTIONS,
    predicted_ellipse,
    ratio_of_delays,
    scales_of_contour,
)
from reliab.tracking.boundary.first_order import first_order_ellipse
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
    towards = scales_of_contour(contour, *predicted_ellipse(response, structure, threshold, side))[1:]
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
        left = size**2 * (1.0 - side.sign * delay / 2.0) * (1.0 - side.sign * delay / 4.0)
        assert left == pytest.approx(delay**2, rel=1e-12)


def test_no_boundary_has_no_multiple():
    assert np.isnan(scales_of_contour(None, 1.0, 1.0)).all()
