"""Reports say what was measured on specimens that yield."""

from reliab.report.sections import limits_section
from reliab.validation.yielding import read_yielding


def test_reports_state_the_measured_effect_of_yielding():
    first = read_yielding()[0]
    assert first.reduction == 2.0
    assert first.exceeding > 0.2
    (points,) = limits_section(()).blocks
    text = " ".join(
        piece if isinstance(piece, str) else piece.source
        for item in points.items
        for piece in item
        if isinstance(piece, str) or hasattr(piece, "source")
    )
    assert "adds damping" not in text
    assert f"{100 * first.exceeding:.2g} % of {first.tests} tests" in text
    assert f"up to {first.largest_ratio:.1f} times" in text
