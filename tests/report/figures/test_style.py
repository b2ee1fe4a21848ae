"""Every axis has a unit; every colour differs in grey too; drawings depend on nothing but what is drawn."""

import re
from types import SimpleNamespace

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.legend import Legend

from reliab.assessment.tracking_index import Windows
from reliab.core.errors import InputError
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.methods.registry import method_of
from reliab.motions.motion import Motion
from reliab.report.document import Figure, Section
from reliab.report.figures.measured_test import tracking_overview
from reliab.report.kinds.criterion.report import criterion_report
from reliab.report.style import RC, FigureWarning, apply_style, line, panels, svg

UNIT = re.compile(r"\[[^\]]+\]$")


def figures(blocks):
    for block in blocks:
        if isinstance(block, Section):
            yield from figures(block.blocks)
        elif isinstance(block, Figure):
            yield block


def figures_of(document):
    return {block.label: block for block in figures(document.blocks)}


@pytest.fixture(scope="module")
def drawn_of_criterion(ellipses_of, rates):
    ellipses = ellipses_of()
    criterion = derive_criterion(ellipses, method=method_of("dirichlet"), joint=True)
    return figures_of(
        criterion_report(title="C", ellipses=ellipses, criteria=[criterion], coverage=rates, provenance={})
    )


@pytest.fixture(scope="module")
def drawn_of_paper(ellipses_of):
    paper, cases, printed, example = (
        pytest.importorskip(f"reliab_studies.paper2017.{name}")
        for name in ("pages.report", "cases", "printed", "example")
    )
    noise = np.random.default_rng(1).normal(size=3000) * np.hanning(3000)
    motion = Motion(name=printed.EXAMPLE, acceleration=noise, time_step=0.015)
    tables = printed.PrintedTables.read()
    structures = (tuple(tables.table3["f_hz"]), tuple(tables.table4["xi"]))
    ellipses = ellipses_of(*structures, motions=100, events=19, names=tables.table2["record"].to_numpy())
    return figures_of(
        paper.paper_report(
            title="P",
            example=example.run_paper_example(motion),
            ellipses=ellipses,
            cases=cases.cases_dataset(cases.run_paper_cases(motion), motion),
            provenance={},
        )
    )


@pytest.fixture(
    scope="module", params=["drawn_of_criterion", pytest.param("drawn_of_paper", marks=pytest.mark.slow)]
)
def drawn(request):
    """All figures of a kind of report."""
    return request.getfixturevalue(request.param)


def test_every_axis_has_a_unit(drawn):
    without = [
        (label, text)
        for label, figure in drawn.items()
        for axes in figure.drawing.axes
        if axes.axison
        for text in (axes.get_xlabel(), axes.get_ylabel())
        if text and not UNIT.search(text.replace("\n", " "))
    ]
    assert without == []


def is_named(axis):
    """Whether an axis has a name, or words for its ticks."""
    ticks = [text.get_text() for text in axis.get_ticklabels()]
    return bool(axis.get_label_text()) or any(tick[:1].isalpha() for tick in ticks)


def test_every_figure_names_both_axes(drawn):
    for label, figure in drawn.items():
        shown = [axes for axes in figure.drawing.axes if axes.axison]
        for name in ("xaxis", "yaxis"):
            assert not shown or any(is_named(getattr(axes, name)) for axes in shown), label


def test_every_figure_fits_the_column(drawn):
    assert {label for label, each in drawn.items() if 25.4 * each.drawing.get_figwidth() > 160.1} == set()


def test_every_figure_says_what_to_see(drawn):
    assert all(len("".join(map(str, each.caption))) > 40 for each in drawn.values())


def cut_off(figure):
    """Names of axes, titles and legends that do not lie within their figure, which cuts them off."""
    with mpl.rc_context({**mpl.rcParamsDefault, **RC}):
        figure.draw_without_rendering()
    of_axes = [
        text for axes in figure.axes for text in (axes.xaxis.label, axes.yaxis.label, axes.title, *axes.texts)
    ]
    of_legends = [text for legend in figure.findobj(Legend) for text in legend.get_texts()]
    boxes = {text.get_text(): text.get_window_extent() for text in (*of_axes, *of_legends)}
    inside = figure.bbox.padded(1.0)
    return [
        name
        for name, box in boxes.items()
        if name.strip() and not (inside.contains(*box.min) and inside.contains(*box.max))
    ]


def test_nothing_is_cut_off_in_the_plane_of_an_assessment():
    centre = np.arange(5.0)
    windows = Windows(
        centre=centre, amplitude=1.0 + 0.01 * centre, delay=1e-3 * centre,
        amplitude_sd=np.full(5, 1e-3), delay_sd=np.full(5, 1e-4), length=2.0,
    )  # fmt: skip
    draws = np.stack([np.linspace(0.98, 1.0, 50), np.linspace(1e-3, 2e-3, 50)])
    tracked = SimpleNamespace(amplitude=0.99, delay=1.5e-3, draws=draws)
    figure = tracking_overview(tracked, boundaries={"95 % of motions": (4e-4, 9.0)}, windows=windows)
    assert cut_off(figure) == []
    figure.axes[0].set_ylabel("Equivalent delay of the actuator $d$ [ms]")
    assert cut_off(figure) == ["Equivalent delay of the actuator $d$ [ms]"]


@pytest.mark.slow
def test_nothing_is_cut_off(drawn):
    cut = {label: cut_off(figure.drawing) for label, figure in drawn.items()}
    assert {label: names for label, names in cut.items() if names} == {}


@pytest.mark.slow
def test_every_figure_of_a_criterion_can_be_drawn(drawn_of_criterion):
    for figure in drawn_of_criterion.values():
        assert svg(figure.drawing).startswith(b"<?xml")


@pytest.mark.slow
def test_every_figure_of_the_paper_can_be_drawn(drawn_of_paper):
    for figure in drawn_of_paper.values():
        assert svg(figure.drawing).startswith(b"<?xml")


def test_lines_differ_without_colour():
    looks = [line(rank, marker=True) for rank in range(8)]
    assert len({(str(look["linestyle"]), look["marker"]) for look in looks}) == 8
    assert len({look["color"] for look in looks}) == 8


def test_the_first_colours_differ_in_lightness():
    weights = np.array([0.2126, 0.7152, 0.0722])
    lightness = [float(weights @ to_rgb(line(rank)["color"])) for rank in range(3)]
    assert abs(np.diff(sorted(lightness))).min() > 0.02


def test_a_drawing_depends_on_nothing_else():
    @apply_style
    def draw():
        figure, axes = panels()
        axes[0, 0].plot([1.0, 2.0], [3.0, 4.0], label="$x^2$")
        axes[0, 0].legend()
        return figure

    first = svg(draw())
    with mpl.rc_context({"font.size": 30.0, "svg.hashsalt": "other", "axes.grid": False}):
        assert svg(draw()) == first


def test_a_figure_that_fails_leaves_a_note_and_a_warning():
    @apply_style
    def rows_of_nothing():
        return panels(0, 1)

    with pytest.warns(FigureWarning, match="rows of nothing"):
        figure = rows_of_nothing()
    assert "could not be drawn" in figure.texts[0].get_text()
    assert svg(figure).startswith(b"<?xml")


def test_bad_input_to_a_figure_is_no_failure_of_the_figure():
    @apply_style
    def refuse():
        raise InputError("A rule", value=1, remedy="None")

    with pytest.raises(InputError, match="A rule"):
        refuse()
