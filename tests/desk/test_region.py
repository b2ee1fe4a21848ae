"""The region before a test is that of `reliab design`, and lies among the motions' own."""

import numpy as np
import pytest

from reliab.assessment.design import boundaries_of_motions, tolerable_errors, tolerable_sides
from reliab.desk.pages.before import limits_html
from reliab.desk.verdict_view import RegionDrawing, half_ellipse

STRUCTURES = [(1.0, 0.02, 1.0), (1.3, 0.035, 0.6), (4.9, 0.04, 0.5)]


@pytest.mark.parametrize(("f", "xi", "alpha"), STRUCTURES)
def test_the_region_has_the_limits_of_the_design(f, xi, alpha):
    region = tolerable_sides(f=f, xi=xi, alpha=alpha, threshold=0.04, confidence=0.9)
    (reference,) = tolerable_errors([f], xi, threshold=0.04, confidences=[0.9], experimental_fraction=alpha)
    assert region["lag"] == pytest.approx((reference.a, reference.b))
    assert region["lead"][1] > region["lag"][1]


@pytest.mark.parametrize(("f", "xi", "alpha"), STRUCTURES)
def test_nearly_all_motions_allow_the_region(f, xi, alpha):
    """The region protects 95 % of the population; of its own sample a few motions more or fewer."""
    region = tolerable_sides(f=f, xi=xi, alpha=alpha, duration=40.0)
    a, b = boundaries_of_motions(f=f, xi=xi, alpha=alpha)
    limit_a, limit_b = region["lag"]
    assert a.size == 100
    assert np.mean((a > limit_a) & (b > limit_b)) > 0.85
    assert np.median(b) > 1.5 * limit_b


@pytest.mark.slow
def test_motions_boundaries_are_the_traced_ones_at_a_shipped_structure():
    from reliab.app.api.simulation import trace_boundaries

    rows = list(trace_boundaries(results="real_suite", f=1, xi=0.02).rows())
    a, b = boundaries_of_motions(f=1.0, xi=0.02)
    assert a == pytest.approx([row["a_inscribed"] for row in rows], rel=0.05)
    assert b == pytest.approx([row["b_inscribed"] for row in rows], rel=0.05)


def test_the_drawing_closes_both_sides():
    drawing = RegionDrawing()
    drawing.update({"lag": (1e-4, 4.0), "lead": (1e-4, 9.0)}, (np.array([4e-4]), np.array([9.0])))
    data = drawing.sources["region"].data
    assert (min(data["y"]), max(data["y"])) == (pytest.approx(-3.0, rel=1e-3), pytest.approx(2.0, rel=1e-3))
    assert max(data["x"]) == pytest.approx(1.0)
    assert half_ellipse(1e-4, 4.0, lead=True)[1].max() == pytest.approx(0.0)


def test_limits_are_said_in_milliseconds_and_per_cent():
    arguments = {"confidence": 0.95, "threshold": 0.05}
    text = limits_html({"lag": (1e-4, 4.0), "lead": (1e-4, 9.0)}, arguments)
    assert "<b>2 ms</b> late, or 3 ms early, or <b>1.00 %</b>" in text
    assert "No test would be accepted" in limits_html({"lag": (0.0, 0.0)}, arguments)
