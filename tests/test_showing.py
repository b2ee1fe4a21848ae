"""Results show themselves in a notebook: tables that escape what they hold, and plots that return axes."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

import reliab
from reliab.assessment.comparison import rank_tests
from reliab.assessment.default_criterion import default_criterion
from reliab.core.shipped import shipped
from reliab.recordings.reading import read_recording
from reliab.sweep.ellipse_dataset import open_ellipses

mpl.use("Agg")


@pytest.fixture(scope="module")
def verdict():
    recording = read_recording(shipped("datasets", "sample_test/test.csv"))
    return reliab.assess(replace(recording, name="<b>mine</b>"), f=1.0, xi=0.02)


@pytest.fixture(scope="module")
def assessments(verdict):
    second = replace(verdict.recording, name="again")
    return reliab.assess([verdict.recording, second], f=1.0, xi=0.02)


@pytest.mark.parametrize("kind", ["one", "several", "compared"])
def test_judged_tests_show_themselves(assessments, kind):
    one = assessments.judged["again"]
    answer = {"one": one, "several": assessments}.get(kind) or rank_tests(assessments.judged)
    rows, lines = answer.to_dataframe(), answer.summary().splitlines()
    assert list(rows["verdict"]) == ["reliable"] * len(rows)
    assert len(lines) > len(rows)
    assert answer.plot().get_xlabel()
    assert answer._repr_html_().startswith("<table")


def test_verdict_is_a_word_and_errors_have_intervals(verdict):
    assert verdict.verdict == "reliable"
    assert verdict.error.rms.low < verdict.error.rms.value < verdict.error.rms.high < verdict.error.mte.value
    assert verdict.summary().startswith(f"{verdict.verdict.shout}: {verdict.reasons[0][:5]}")


class Cells(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.tags, self.rows = [], {}
        self.feed(text)

    def handle_starttag(self, tag, _attributes):
        self.tags.append(tag)

    def handle_data(self, text):
        if self.tags[-1] == "th":
            self.head = text
        elif self.tags[-1] == "td":
            self.rows[self.head] = text


def test_a_verdict_is_a_table_with_names_as_text(verdict):
    table = Cells(verdict._repr_html_())
    assert "b" not in table.tags
    assert table.rows["verdict"] == "reliable"
    assert table.rows["amplitude A"] == f"{verdict.tracking.amplitude:.4f}"


def test_a_criterion_is_a_table():
    table = Cells(default_criterion(0.8, 0.03)._repr_html_())
    assert table.rows["motions"] == "100 of 19 earthquakes"
    assert table.rows["natural frequency"] == "0.75 to 1 Hz"


def test_a_suite_is_a_table_of_its_earthquakes():
    suite = reliab.load_motions("synthetic")
    table = Cells(suite[:3]._repr_html_())
    assert table.rows == {"SYN001": "SYN001/H1, SYN001/H2", "SYN002": "SYN002/H1"}
    assert "0 more" not in suite._repr_html_()


@pytest.mark.slow
def test_a_diagnosis_is_a_table_and_two_bars_for_each_block():
    diagnosis = reliab.diagnose("rig_a")
    table = Cells(diagnosis._repr_html_())
    assert table.rows["verdict"] == "named"
    assert table.rows["coulomb friction"].startswith("probability 0.99")
    assert repr(diagnosis) == "<Diagnosis of rig_a: named (coulomb_friction)>"
    assert len(diagnosis.plot().patches) == 2 * len(diagnosis.blocks)


def test_each_half_of_a_region_ends_on_no_delay_at_the_limits_of_its_side():
    criterion = default_criterion(1.0, 0.02)
    axes = criterion.plot(1.0, 0.02)
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    for rank, (side, sign) in enumerate((("lag", 1.0), ("lead", -1.0))):
        x, up = axes.lines[rank].get_data()
        a, b = (float(limit) for limit in criterion.limits(1.0, 0.02, side))
        assert np.max(sign * up) == pytest.approx(b**0.5, rel=1e-6)
        assert np.min(sign * up) >= -1e-12
        np.testing.assert_allclose(np.sort(x)[[0, -1]], [-100 * a**0.5, 100 * a**0.5])
        np.testing.assert_allclose(up[[0, -1]], 0.0, atol=1e-12)  # type: ignore[index]
        assert f"{100 * a**0.5:.2f} % or {b**0.5:.2f} ms" in names[rank]


def test_the_ellipses_of_leads_are_the_wider_ones_on_no_delay():
    """Why the halves of a region do not meet there, for every motion that ships."""
    ellipses = open_ellipses(shipped("datasets", "real_suite/ellipses.nc")).sel(curve="inscribed")
    amplitudes = ellipses.sel(f=1.0, xi=0.02, threshold=0.05, metric="rms")["a"]
    ratios = np.sqrt(amplitudes.sel(side="lead") / amplitudes.sel(side="lag")).values  # type: ignore[attr-defined]
    assert ratios.min() > 1.0
    assert ratios.max() < 1.15


def test_error_is_drawn_over_time(verdict):
    axes = verdict.plot()
    time, error = axes.lines[0].get_data()
    assert time[-1] == pytest.approx(verdict.recording.duration)
    np.testing.assert_allclose(error, 1e3 * verdict.error.displacements[0].smooth_error)


def test_a_suite_a_recording_a_campaign_and_rates_show_themselves(verdict):
    suite = reliab.load_motions("synthetic")[:3]
    campaign = reliab.read_campaign(shipped("datasets", "campaigns/rig_a"))
    for answer, rows in ((suite, 3), (verdict.recording, 1), (campaign, 3)):
        assert len(answer.to_dataframe()) == rows
        assert len(answer.summary().splitlines()) > rows
        assert answer._repr_html_().startswith("<table")
        assert answer.plot().get_xlabel() in {"duration [s]", "time [s]"}


SHOWING = ("summary", "plot", "to_dataframe", "_repr_html_")
FOREIGN_TYPES = (Path, xr.Dataset, dict, tuple, int, type(None))


def test_every_answer_of_the_interface_shows_itself():
    functions = [getattr(reliab, name) for name in dir(reliab) if name.islower()]
    answers = {
        inspect.signature(answer_type).return_annotation
        for answer_type in functions
        if inspect.isfunction(answer_type)
    }
    own_types = [
        answer_type
        for answer_type in answers
        if isinstance(answer_type, type) and not issubclass(answer_type, FOREIGN_TYPES)
    ]
    assert len(own_types) > 10
    assert [
        (answer_type, way) for answer_type in own_types for way in SHOWING if not hasattr(answer_type, way)
    ] == []


@pytest.mark.parametrize("kind", ["record", "monitor"])
def test_other_answers_show_themselves(kind, tmp_path):
    if kind == "record":
        answer = reliab.record("sample_test")
        assert {line.get_label() for line in answer.plot().lines} == {"command", "measured"}
    else:
        answer = reliab.export_monitor(("c", tmp_path), f=1, xi=0.02, rate=1024)
        assert answer.plot().get_xscale() == "symlog"
    assert answer.summary().splitlines()
    assert answer._repr_html_().startswith("<table")
    assert len(answer.to_dataframe()) == 1


DRAWN: Mapping[str, Callable[[], Any]] = {
    "test": lambda: reliab.assess("sample_test", f=1, xi=0.02),
    "recording": lambda: reliab.read_recording(shipped("datasets", "sample_test/test.csv")),
    "record": lambda: reliab.record("sample_test"),
    "suite": lambda: reliab.load_motions("synthetic")[:3],
    "campaign": lambda: reliab.read_campaign("rig_a"),
    "criterion": lambda: reliab.published_criterion("guo_2017_18"),
    "design": lambda: reliab.design_test(f=[0.5, 1]),
    "calibration": lambda: reliab.calibrate("sample_test"),
    "studies": reliab.list_studies,
    "rig": lambda: reliab.list_rig(shipped("datasets", "sample_rig")),
}


def labels_of(axes):
    legend = axes.get_legend()
    ticks = [
        tick.label1
        for axis in (axes.xaxis, axes.yaxis)
        for tick in axis.get_major_ticks()
        if axis.get_view_interval().min() <= tick.get_loc() <= axis.get_view_interval().max()
    ]
    texts = [] if legend is None else legend.get_texts()
    return [axes.title, axes.xaxis.label, axes.yaxis.label, *ticks, *texts]


@pytest.mark.parametrize("name", DRAWN)
def test_no_label_of_a_figure_is_cut(name):
    axes = DRAWN[name]().plot()
    canvas = axes.figure.canvas
    canvas.draw()
    width, height = canvas.get_width_height()
    for label in labels_of(axes):
        if label.get_text():
            box = label.get_window_extent(canvas.get_renderer())
            assert -1 <= box.x0 <= box.x1 <= width + 1, label
            assert -1 <= box.y0 <= box.y1 <= height + 1, label
