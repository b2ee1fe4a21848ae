"""Tables on the terminal: title, headings and each cell below the heading that it belongs to."""
# ruff: noqa: SLF001 - single tables of commands

import re
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from reliab.app.api.followed_test import Message
from reliab.app.cli import motions, record, validate
from reliab.app.cli.assess import show_several
from reliab.app.cli.criterion import show_criteria, show_design
from reliab.app.cli.monitor import _table
from reliab.assessment.design import TolerableErrors
from reliab.assessment.monitor import Monitor
from reliab.core.significant_digits import percent_with_interval
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.motions.faults import MotionFault
from reliab.report import terminal
from reliab.structures.structure import Structure


@pytest.fixture(autouse=True)
def wide(monkeypatch):
    """A terminal on which no cell is broken."""
    monkeypatch.setenv("COLUMNS", "400")


@pytest.fixture
def tables(monkeypatch):
    """Tables that were printed, by their titles: headings with how they stand, and rows."""
    tables_by_title, make = {}, terminal.rich_table

    def rich_table(table):
        output = make(table)
        tables_by_title.setdefault(table.caption or f"table {len(tables_by_title)}", output)
        return output

    monkeypatch.setattr(terminal, "rich_table", rich_table)
    return tables_by_title


def cells(table):
    """Rows of a table as dictionaries by heading, and where its cells stand."""
    headings = [str(column.header) for column in table.columns]
    columns = [[str(cell) for cell in column.cells] for column in table.columns]
    return [dict(zip(headings, row, strict=True)) for row in zip(*columns, strict=True)]


RIG = {
    "metric": "rms",
    "stable": True,
    "median": 0.0111,
    "largest": 0.0333,
    "threshold": 0.05,
    "share_below": 0.97,
    "motions": [{"A": 1.02, "d_ms": 3.0}, {"A": 0.98, "d_ms": 1.5}],
}
LIMITS = {
    "f": 1.25, "xi": 0.03, "alpha": 0.75, "threshold": 0.04, "position": "inside", "confidence": 0.9,
    "a": 1.11e-4, "b": 2.22, "amplitude_limit": 0.0333, "delay_limit_ms": 4.44, "lead_limit_ms": 5.55,
    "n_motions": 61, "motions": "motions", "n_events": 17, "population": "M 6 to 7", "joint": True,
    "method": "dirichlet", "law": "none", "metric": "rms", "window": "record", "curve": "ellipse",
    "warnings": ["few earthquakes"],
}  # fmt: skip
POSTERIOR = {
    "threshold": 0.04, "metric": "rms", "ensembles": 4, "walkers": 32, "steps": 900, "accepted": 0.31,
    "converged": True, "complaints": [], "parameters": [],
}  # fmt: skip


def print_criteria(capsys, rows, posteriors=()):
    show_criteria({"criteria": rows, "posteriors": posteriors}, details=True)
    return " ".join(capsys.readouterr().out.split())


def test_limits_stand_below_their_headings(tables, capsys):
    text = print_criteria(capsys, [LIMITS, {**LIMITS, "f": 2.5, "lead_limit_ms": None, "confidence": None}])
    first, second = cells(tables["(A − 1)²/a + d²/b ≤ 1 from 61 motions of 17 earthquakes"])
    assert first == {
        "f [Hz]": "1.25", "ξ [-]": "0.03", "α [-]": "0.75", "error [-]": "0.04", "confidence [-]": "0.9",
        "a [-]": "0.000111", "b [ms²]": "2.22", "|A − 1| alone ≤": "0.0333", "lag alone ≤ [ms]": "4.44",
        "lead alone ≤ [ms]": "5.55",
    }  # fmt: skip
    assert (second["confidence [-]"], second["lead alone ≤ [ms]"]) == ("none", "-")
    for sentence in (
        "from 61 motions of 17 earthquakes", "Valid for ground motions like these: M 6 to 7.",
        "few earthquakes",
        "Method: dirichlet, a and b together. Law: none.",
        "Share α of the stiffness in the laboratory: 0.75.",
        "Window: record.",
    ):  # fmt: skip
        assert sentence in text
    assert "The case asked for lies" not in text


def test_the_error_of_a_rig_stands_below_its_heading(tables, capsys):
    show_criteria({"criteria": [LIMITS], "rig": RIG}, details=True)
    rows = {row[""]: row["value"] for row in cells(tables["Error of the described rig, RMS error"])}
    assert rows == {
        "median of the motions": "1.11 %",
        "largest": "3.33 %",
        "motions below 0.05": "97 %",
        "A, least to largest": "0.9800 to 1.0200",
        "d_ms, least to largest": "1.500 to 3.000",
    }
    show_criteria({"criteria": [LIMITS], "rig": {**RIG, "stable": False}}, details=True)
    assert "the test of this frame is unstable" in capsys.readouterr().out


@pytest.mark.parametrize(("truth", "noted"), [("ellipse", True), ("simulation", False)])
def test_probabilities_stand_below_their_heading(tables, truth, noted, capsys):
    row = {"stated": 0.9, "observed": 0.85, "low": 0.7, "high": 0.95, "tests": 43}
    validate.show_probabilities({"scheme": "leave_one_event_out", "truth": truth, "bins": [row]})
    assert cells(tables["Probabilities of tests, leave one event out"]) == [
        {
            "stated probability": "90.0 %",
            "good tests (95 % interval)": "85.0 % (70.0 % … 95.0 %)",
            "tests": "43",
        }
    ]
    assert ("llipse" in capsys.readouterr().out) is noted


def test_several_verdicts_stand_below_their_headings(tables, capsys):
    verdict = {
        "file": "a.csv",
        "metric": "rms",
        "threshold": 0.05,
        "verdict": "not_reliable",
        "probability": 0.25,
        "error": {"rms": {"value": 0.06, "low": 0.055, "high": 0.066}},
        "A": 0.99,
        "d_ms": 1.5,
        "warnings": ["Look."],
        "reliable": False,
        "reasons": ["Too large."],
    }
    show_several([verdict, {"file": "b/c.csv", "fault": "c.csv: no command"}])
    assert cells(tables["Verdicts on 2 tests, RMS error against 5 %"]) == [
        {
            "test": "a.csv",
            "verdict": "not reliable",
            "error": "6.0 %",
            "90 % interval": "5.5 to 6.6 %",
            "probability": "0.25",
            "A": "0.99000",
            "d, ms": "1.5000",
        },
        {
            "test": "b/c.csv",
            "verdict": "not judged",
            **dict.fromkeys(("error", "90 % interval", "probability", "A", "d, ms"), ""),
        },
    ]
    assert capsys.readouterr().out.splitlines()[-3:] == [
        "a.csv: Too large.",
        "a.csv: Warning: Look.",
        "b/c.csv: no command",
    ]


def test_tolerable_errors_stand_below_their_headings_and_bars_are_as_long_as_the_delay(tables, capsys):
    def tolerance(f, delay, confidence=0.9, is_outside=False):  # noqa: FBT002
        return TolerableErrors(
            frequency=f,
            damping_ratio=0.03,
            threshold=0.05,
            confidence=confidence,
            a=0.0004,
            b=(1e3 * delay) ** 2,
            critical_delay=0.05,
            outside_validity=is_outside,
            population="of here",
        )

    rows = [tolerance(1.25, 0.004), tolerance(2.5, 0.002, is_outside=True)]
    chart = [tolerance(1.0, 0.004), tolerance(2.0, 0.002), tolerance(3.0, 0.009, confidence=0.5)]
    show_design(SimpleNamespace(tolerances=rows, chart=chart), details=True)
    limits, bars = map(cells, tables.values())
    assert [
        (row["f [Hz]"], row["confidence"], row["|A − 1| alone"], row["d alone [ms]"]) for row in limits
    ] == [("1.25", "90 %", "0.0200", "4.000"), ("2.5*", "90 %", "0.0200", "2.000")]
    both = rows[0].both
    assert limits[0]["|A − 1| and"] == f"{both[0]:.4f}"
    assert limits[0]["d together [ms]"] == f"{1e3 * both[1]:.3f}"
    assert [(row["f [Hz]"], row["d alone [ms]"], len(row["d"])) for row in bars] == [
        ("1", "4.000", 40),
        ("2", "2.000", 20),
    ]
    assert list(tables) == ["Tolerable errors at ξ = 0.03, error 5 %", "Over the frequency, at 90 %"]
    output = capsys.readouterr().out
    assert "Valid for ground motions like these: of here." in output
    assert "the criterion does not cover *" in output


def test_calibrated_channels_stand_below_their_headings(tables):
    record._show_calibration(
        SimpleNamespace(
            skew_ms=StatedValue(1.25, 0.05),
            scale=StatedValue(1.002, 0.0005),
            hysteresis=None,
            noise_m=1.5e-5,
            command_noise_m=0.0,
            resolution_m=2e-6,
            notes=(),
        )
    )
    output = cells(tables["What the measured channel adds to the motion"])
    rows = {row[""]: (row["value"], row["± 1 sd"]) for row in output}
    assert list(rows.values()) == [
        ("1.25", "0.05"),
        ("1.0020", "0.0005"),
        ("not determined", ""),
        ("0.015", ""),
        ("none", ""),
        ("0.002", ""),
    ]
    assert [name.partition(" ")[0] for name in rows] == [
        "delay",
        "scale",
        "hysteresis",
        "noise",
        "noise",
        "step",
    ]


@pytest.mark.parametrize("joint", [True, False])
def test_a_population_elsewhere_and_separate_limits_are_told(capsys, joint):
    text = print_criteria(capsys, [{**LIMITS, "position": "outside", "joint": joint}])
    assert "The case asked for lies outside of these motions." in text
    assert ("a and b together" in text) is joint
    baseline = print_criteria(capsys, [{**LIMITS, "population": "", "warnings": []}])
    assert "Valid for ground motions like these" not in baseline
    assert "Note:" not in baseline


@pytest.mark.parametrize("converged", [True, False])
def test_a_posterior_says_whether_it_has_converged(capsys, converged):
    complaint = [] if converged else ["R-hat of mean is 1.2"]
    text = print_criteria(capsys, [LIMITS], [{**POSTERIOR, "converged": converged, "complaints": complaint}])
    title = "Posterior at 0.04 of rms: 4 ensembles of 32 walkers, 900 steps, 31 % of the moves accepted"
    assert title in text
    assert ("Converged:" in text) is converged
    assert ("THIS POSTERIOR HAS NOT CONVERGED." in text) is not converged
    assert ("R-hat of mean is 1.2" in text) is not converged


def test_every_fault_has_its_file_line_rule_value_and_remedy(capsys):
    faults = [
        MotionFault(file="/records/a.at2", line=7, rule="A rule", value="1 value", remedy="A remedy"),
        MotionFault(file="/records/b.at2", line=None, rule="Another", value="2 values", remedy="None"),
    ]
    motions._show_faults(faults, 9, ["/records"])
    text = capsys.readouterr().out
    assert "2 faults in 2 files" in text
    assert [re.split(r" {2,}", line.strip()) for line in text.splitlines() if "at2" in line] == [
        ["a.at2", "7", "A rule", "1 value", "A remedy"],
        ["b.at2", "Another", "2 values", "None"],
    ]
    motions._show_notes(faults[:1], ["/records"])
    assert capsys.readouterr().out == "Note: a.at2: 1 value. A remedy.\n"
    motions._show_faults([], 9, ["/records"])
    assert capsys.readouterr().out == "9 records, no faults.\n"


def test_files_elsewhere_keep_their_whole_path():
    assert motions._path_within_sources("/elsewhere/a.at2", ["/records"]) == "/elsewhere/a.at2"


def test_the_table_of_a_running_test_grows_with_knowledge():
    time = np.arange(3000) / 256.0
    command = np.minimum(time, 1.0) * 0.01 * np.sin(6.0 * time)
    monitor = Monitor(Structure(frequency=1.0, damping_ratio=0.05), 1.0 / 256.0)
    message = Message(kind="update", content={}, monitor=monitor, alarms={})

    def shown():
        screen = Console(width=100)
        with screen.capture() as caught:
            screen.print(_table(message, Metric.RMS, 0.05))
        return " ".join(caught.get().split())

    monitor.feed(command[:100], 0.99 * command[:100])
    assert "not settled" in shown()
    assert "90 % interval" not in shown()
    monitor.feed(command[100:], 0.99 * command[100:])
    result = monitor.ask(draws=8)
    message.alarms["energy"] = "the loop has gained energy"  # type: ignore[index]
    text = shown()
    assert percent_with_interval(result.rms.value, result.rms.low, result.rms.high) in text
    assert f"{result.probability(0.05):.3f}" in text
    assert f"{100 * monitor.now.damping.ratio:.2f} ± {100 * monitor.now.damping.deviation:.2f} %" in text
    assert "the loop has gained energy" in text
