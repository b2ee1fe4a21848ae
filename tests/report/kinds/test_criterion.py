"""A criterion can be reported whatever its motions, structures and names."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.criterion.derivation import derive_criterion
from reliab.criterion.methods.registry import method_of
from reliab.report.document import Remark
from reliab.report.kinds.criterion.report import criterion_report
from reliab.sampling.posterior_sample import ConvergenceWarning


def report(ellipses, *, method="dirichlet", coverage=None, confidences=(0.95, 0.8), **changes):
    criteria = [
        derive_criterion(ellipses, method=method_of(method), joint=True, threshold=threshold, confidence=row)
        for threshold in (0.05, 0.02)
        for row in confidences
    ]
    content = {"title": "A criterion", "provenance": {"seed": 1}, **changes}
    return criterion_report(ellipses=ellipses, criteria=criteria, coverage=coverage, **content), criteria


def words(prose):
    return "".join(str(getattr(piece, "text", getattr(piece, "source", piece))) for piece in prose)


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("frequencies", "damping_ratios"),
    [
        ((0.5, 1.0, 2.0), (0.02, 0.05)),
        pytest.param((0.5, 1.0, 2.0), (0.02,), marks=pytest.mark.slow),
        pytest.param((1.0,), (0.02, 0.05), marks=pytest.mark.slow),
        ((3.0,), (0.04,)),
    ],
)
def test_any_grid_of_structures(ellipses_of, text_of, frequencies, damping_ratios, rates):
    document, _ = report(ellipses_of(frequencies, damping_ratios), coverage=rates)
    text = text_of(document)
    assert "each alone, without the other error" in text
    assert "over the peak (not the RMS) of the exact one, over the whole record" in text
    assert "$alpha$" not in text
    assert "Ellipses fitted by least squares to the boundaries" in text
    for f in frequencies:
        assert f"{f:g}" in text


@pytest.mark.slow
def test_the_verdict_states_the_limits_of_the_first_criterion(ellipses_of):
    document, (first, *_) = report(ellipses_of())
    a, b = (float(limit) for limit in first.limits(1.0, 0.02))
    verdict_text = words(document.verdict)
    assert f"{100 * np.sqrt(a):.2g} %" in verdict_text
    assert f"{np.sqrt(b):.2f} ms" in verdict_text


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("motions", "events"), [(3, 1), (4, 4), pytest.param(60, 50, marks=pytest.mark.slow)]
)
def test_any_number_of_motions_and_earthquakes(ellipses_of, set_without_warnings, motions, events):
    document, _ = report(ellipses_of((1.0,), (0.02,), motions=motions, events=events))
    set_without_warnings(document)


@pytest.mark.parametrize("position", ["inside", "outside"])
def test_outside_of_its_population_no_share_is_promised(ellipses_of, text_of, position):
    ellipses = ellipses_of((0.5, 1.0), (0.02,))
    criterion = derive_criterion(ellipses, confidence=0.93)
    lies = replace(criterion, provenance=replace(criterion.provenance, position=position))
    text = text_of(criterion_report(title="C", ellipses=ellipses, criteria=[lies], provenance={}))
    assert ("93 %" in text) == (position == "inside")
    assert ("no share of" in text) == (position == "outside")


@pytest.mark.slow
def test_an_unconverged_posterior_is_stated_before_any_limit(ellipses_of):
    ellipses = ellipses_of((1.0,), (0.02,))
    with pytest.warns(ConvergenceWarning):
        criterion = derive_criterion(ellipses, method="hierarchical", steps=20)
    document = criterion_report(title="A criterion", ellipses=ellipses, criteria=[criterion], provenance={})
    first = document.blocks[0].blocks[0]
    assert isinstance(first, Remark)
    assert "NOT CONVERGED" in words(first.text)


def test_too_few_motions_for_the_promise_are_told(ellipses_of, set_without_warnings):
    document, criteria = report(
        ellipses_of((1.0,), (0.02,)), method="order_statistic", confidences=(0.8, 0.999)
    )
    assert min(float(criterion.limits(1.0, 0.02)[0]) for criterion in criteria) == 0.0
    set_without_warnings(document)


@pytest.mark.slow
def test_names_from_a_users_catalogue_are_text(ellipses_of, set_without_warnings):
    names = [f"$#*_@{rank}\\ <b> {'x' * 60}" for rank in range(24)]
    document, _ = report(ellipses_of((1.0,), (0.02,), names=names), title="#panic() $ *", notes=("$ # @x",))
    set_without_warnings(document)


@pytest.mark.slow
def test_motions_without_an_ellipse_are_left_out(ellipses_of, set_without_warnings):
    ellipses = ellipses_of((1.0,), (0.02,)).copy(deep=True)
    ellipses["a"][:2] = np.nan
    document, _ = report(ellipses)
    set_without_warnings(document)
