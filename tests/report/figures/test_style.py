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
def criterion_figures(ellipses_of, rates):
    ellipses = ellipses_of()
    criterion = derive_criterion(ellipses, method=method_of("dirichlet"), joint=True)
    return figures_of(
        criterion_report(title="C", ellipses=ellipses, criteria=[criterion], coverage=rates, provenance={})
    )


@pytest.fixture(scope="module")
def paper_figures(ellipses_of):
    paper, cases, output, example = (
        pytest.importorskip(f"reliab_studies.paper2017.{name}")
        for name in ("pages.report", "cases", "printed", "example")
    )
    noise = np.random.default_rng(1).normal(size=3000) * np.hanning(3000)
    motion = Motion(name=output.EXAMPLE, acceleration=noise, time_step=0.015)
    tables = output.PrintedTables.read()
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
    scope="module", params=["criterion_figures", pytest.param("paper_figures", marks=pytest.mark.slow)]
)
def every_figure(request):
    """All figures of a kind of report."""
    return request.getfixturevalue(request.param)


def test_every_axis_has_a_unit(every_figure):
    baseline = [
        (label, text)
        for label, figure in every_figure.items()
        for axes in figure.drawing.axes
        if axes.axison
        for text in (axes.get_xlabel(), axes.get_ylabel())
        if text and not UNIT.search(text.replace("\n", " "))
    ]
    assert baseline == []


def is_named(axis):
    """Whether an axis has a name, or words for its ticks."""
    ticks = [text.get_text() for text in axis.get_ticklabels()]
    return bool(axis.get_label_text()) or any(tick[:1].isalpha() for tick in ticks)


def test_every_figure_names_both_axes(every_figure):
    for label, figure in every_figure.items():
        output = [axes for axes in figure.drawing.axes if axes.axison]
        for name in ("xaxis", "yaxis"):
            assert not output or any(is_named(getattr(axes, name)) for axes in output), label


def test_every_figure_fits_the_column(every_figure):
    assert {
        label for label, row in every_figure.items() if 25.4 * row.drawing.get_figwidth() > 160.1
    } == set()


def test_every_figure_has_a_caption(every_figure):
    assert all(len("".join(map(str, row.caption))) > 40 for row in every_figure.values())


def cut_off(figure):
    """Names of axes, titles and legends that do not lie within their figure, which cuts them off."""
    with mpl.rc_context({**mpl.rcParamsDefault, **RC}):
        figure.draw_without_rendering()
    axes_texts = [
        text for axes in figure.axes for text in (axes.xaxis.label, axes.yaxis.label, axes.title, *axes.texts)
    ]
    legend_texts = [text for legend in figure.findobj(Legend) for text in legend.get_texts()]
    boxes = {text.get_text(): text.get_window_extent() for text in (*axes_texts, *legend_texts)}
    is_inside = figure.bbox.padded(1.0)
    return [
        name
        for name, box in boxes.items()
        if name.strip() and not (is_inside.contains(*box.min) and is_inside.contains(*box.max))
    ]


def test_nothing_is_cut_off_in_the_plane_of_an_assessment():
    centre = np.arange(5.0)
    windows = Windows(
        centre=centre, amplitude=1.0 + 0.01 * centre, delay=1e-3 * centre,
        amplitude_sd=np.full(5, 1e-3), delay_sd=np.full(5, 1e-4), length=2.0,
    )  # fmt: skip
    draws = np.stack([np.linspace(0.98, 1.0, 50), np.linspace(1e-3, 2e-3, 50)])
    index = SimpleNamespace(amplitude=0.99, delay=1.5e-3, draws=draws)
    figure = tracking_overview(index, boundaries={"95 % of motions": (4e-4, 9.0)}, windows=windows)
    assert cut_off(figure) == []
    figure.axes[0].set_ylabel("Equivalent delay of the actuator $d$ [ms]")
    assert cut_off(figure) == ["Equivalent delay of the actuator $d$ [ms]"]


@pytest.mark.slow
def test_nothing_is_cut_off(every_figure):
    cut = {label: cut_off(figure.drawing) for label, figure in every_figure.items()}
    assert {label: names for label, names in cut.items() if names} == {}


@pytest.mark.slow
def test_every_figure_of_a_criterion_can_be_drawn(criterion_figures):
    for figure in criterion_figures.values():
        assert svg(figure.drawing).startswith(b"<?xml")


@pytest.mark.slow
def test_every_figure_of_the_paper_can_be_drawn(paper_figures):
    for figure in paper_figures.values():
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


def test_a_failed_figure_leaves_a_note_and_a_warning():
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
