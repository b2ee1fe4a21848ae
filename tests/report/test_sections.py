"""Sections say what their criterion and rates are: each sentence with its counterpart."""

import dataclasses
from types import SimpleNamespace

import pandas as pd
import pytest

from reliab.criterion.derivation import derive_criterion
from reliab.criterion.methods.registry import method_of
from reliab.report.document import Figure, Table
from reliab.report.kinds import discrepancy_report as discrepancy
from reliab.report.kinds.criterion.result import ReportedCriteria, result_section
from reliab.report.sections import (
    _FITTED_ELLIPSE,
    _INSCRIBED_ELLIPSE,
    limits_section,
    method_section,
    rates_section,
)


def words(blocks):
    """Every word of the paragraphs, points and captions of some blocks."""
    return " ".join(_pieces(blocks))


def _pieces(thing):
    if isinstance(thing, str):
        yield thing
    elif isinstance(thing, dict):
        yield from _pieces(list(thing.values()))
    elif isinstance(thing, list | tuple):
        for part in thing:
            yield from _pieces(part)
    elif dataclasses.is_dataclass(thing) and not isinstance(thing, Figure | Table):
        for field in dataclasses.fields(thing):
            yield from _pieces(getattr(thing, field.name))


def rates(frequencies=(0.5, 2.0), **levels):
    return pd.DataFrame(
        [
            {"candidate": name, "confidence": c, "f": f,
             "rate": rate * c, "low": rate * c - 0.05, "high": rate * c + 0.02}
            for name, (rate, confidences) in levels.items()
            for c in confidences
            for f in (float("nan"), *frequencies)
        ]
    )  # fmt: skip


def test_the_division_is_told_where_there_is_one():
    plain, divided_section = (
        rates_section(rates(ours=(1.0, (0.8, 0.9))), confidence=0.9, division=division)
        for division in ("", "by region")
    )
    assert plain.title == "Put to the test on held-out earthquakes"
    assert plain.label == "sec:coverage"
    assert "Whole earthquakes were held out in turn" in words(plain.blocks)
    assert "Division" not in words(plain.blocks)
    assert divided_section.title == "Put to the test: by region"
    assert divided_section.label == "sec:coverage-by-region"
    assert "Division: by region" in words(divided_section.blocks)
    assert "Whole earthquakes" not in words(divided_section.blocks)
    labels = [block.label for block in divided_section.blocks if isinstance(block, Figure | Table)]
    assert labels == [f"{kind}-by-region" for kind in ("fig:calibration", "fig:by-frequency", "tab:rates")]


def test_the_figures_hold_their_criteria():
    table = rates(ours=(0.95, (0.8, 0.9)), printed=(0.5, (0.9,)))
    opening, calibration, frequency_section, shares = rates_section(table, confidence=0.89, leads=True).blocks
    assert isinstance(opening, tuple)
    assert calibration.leads
    caption = words((calibration.caption,))
    assert "Printed laws state one confidence only" in caption
    legend_texts = [text.get_text() for text in calibration.drawing.legends[0].get_texts()]
    assert legend_texts == ["observed as stated", "ours"]
    names = [text.get_text() for text in frequency_section.drawing.legends[0].get_texts()]
    assert sorted(names) == ["ours", "printed", "stated 90 %"]
    assert "at a stated 90" in words((frequency_section.caption,))
    assert shares.frame["confidence"].tolist() == [0.8, 0.9, 0.9]
    assert shares.frame["containment rate"].tolist() == pytest.approx([0.76, 0.855, 0.45])
    assert shares.frame["containment low"].tolist() == pytest.approx([0.71, 0.805, 0.40])
    assert [column.key for column in shares.columns] == [
        "candidate", "confidence", "containment rate", "containment low", "containment high"
    ]  # fmt: skip


def test_nothing_is_said_of_printed_laws_where_there_are_none_or_no_others():
    for levels in ({"ours": (1.0, (0.8, 0.9))}, {"printed": (1.0, (0.9,))}):
        _, calibration, *_ = rates_section(rates(**levels), confidence=0.9).blocks
        assert "Printed laws" not in words((calibration.caption,))
        assert not calibration.leads


def test_one_frequency_needs_no_figure_by_frequency():
    blocks = rates_section(rates((1.0,), ours=(1.0, (0.8, 0.9))), confidence=0.9).blocks
    assert [type(block) for block in blocks] == [tuple, Figure, Table]


@pytest.fixture(scope="module")
def criterion(ellipses_of):
    return derive_criterion(ellipses_of((1.0,), (0.02,)), method=method_of("dirichlet"), joint=True)


def method_in_words(criterion, fraction=1.0):
    return words(method_section(criterion, experimental_fraction=fraction, window="record").blocks)


@pytest.mark.parametrize("curve", ["inscribed", "ellipse"])
def test_the_boundary_names_its_curve(criterion, curve):
    provenance = dataclasses.replace(criterion.provenance, curve=curve)
    arguments = dataclasses.replace(criterion, provenance=provenance)
    sentences = method_in_words(arguments)
    reference, second = (_INSCRIBED_ELLIPSE, _FITTED_ELLIPSE)[:: 1 if curve == "inscribed" else -1]
    assert reference in sentences
    assert second not in sentences
    assert _FITTED_ELLIPSE in method_in_words(None)


@pytest.mark.parametrize("joint", [True, False])
def test_the_confidence_names_its_scope(criterion, joint):
    sentences = method_in_words(dataclasses.replace(criterion, joint=joint))
    assert ("for both together" in sentences) is joint
    assert ("for each of them separately" in sentences) is not joint


@pytest.mark.parametrize(
    ("fraction", "sentence"), [(1.0, "All stiffness stands"), (0.4, "does not hold for a larger")]
)
def test_the_share_in_the_laboratory_is_told(fraction, sentence):
    sentences = method_in_words(None, fraction)
    assert sentence in sentences
    assert ("40" in sentences) is (fraction == 0.4)
    assert "constant gain and a constant delay" in sentences


def test_limits_begin_with_their_sentences():
    (points,) = limits_section(["First sentence."]).blocks
    assert points.items[0] == "First sentence."
    assert len(points.items) == 3


@pytest.mark.parametrize(
    ("explained", "said"), [(True, "does not differ from noise"), (False, "varies with no quantity")]
)
def test_a_residual_is_noise_only_in_a_complete_model(monkeypatch, explained, said):
    monkeypatch.setattr("reliab.report.kinds.discrepancy_figures.draw_or_skip", lambda *_: ())
    section = discrepancy.location_section(SimpleNamespace(where=(), is_explained=explained, blocks=()))
    (only,) = section.blocks
    assert said in words([only])


@pytest.mark.parametrize(("motions", "said"), [(5, 1), (100, 0)])
def test_a_criterion_of_too_few_motions_is_said_to_promise_nothing(ellipses_of, motions, said):
    subset = ellipses_of((1.0,), (0.02,)).isel(motion=slice(0, motions))
    criterion = derive_criterion(subset, f=1.0, xi=0.02, method=method_of("dirichlet"), joint=True)
    section = result_section(ReportedCriteria(ellipses=subset, criteria=(criterion,)), "motions")
    assert words(section.blocks).count("too few for the promise at 95 %") == said
