"""What commands print of their results: each value in its place, each sentence where something is to say."""

import re
from types import SimpleNamespace

import pytest

from reliab.app.cli.assess import show_briefly, show_degrees
from reliab.app.cli.criterion import _show_own_boundary
from reliab.app.cli.monitor import _export
from reliab.app.cli.record import _check
from reliab.app.cli.rig import show_added
from reliab.app.cli.validate import show_criteria as show_rates


@pytest.fixture(autouse=True)
def wide(monkeypatch):
    """A terminal on which no cell is broken."""
    monkeypatch.setenv("COLUMNS", "400")


def print_result(capsys, show, *arguments):
    show(*arguments)
    return capsys.readouterr().out


def test_the_boundary_of_a_motion_itself_is_a_row_for_each_structure(capsys):
    row = {"motion": "NGA_1", "f": 1.25, "xi": 0.03, "threshold": 0.04, "a": 1.11e-4, "b": 2.22}
    text = print_result(capsys, _show_own_boundary, [row, {**row, "f": 2.5}])
    assert "Boundary of NGA_1 itself" in text
    numbers = [line.replace("│", " ").split() for line in text.splitlines() if "0.03" in line]
    assert numbers == [[f, "0.03", "0.04", "0.000111", "2.22"] for f in ("1.25", "2.5")]


RATE = {"rate": 0.9, "low": 0.8, "high": 0.95}
RATES = {
    "scheme": "events", "n_motions": 60, "n_events": 20, "metric": "rms", "threshold": 0.05, "window": "12",
    "rows": [
        {
            "candidate": "ours", "confidence": 0.95, "containment": RATE,
            "containment_by_ellipse": {"rate": 0.85}, "false_safe": {**RATE, "rate": 0.02, "low": None},
            "accepted_share": {**RATE, "rate": None},
        }
    ],
    "rows_lead": [], "judged_on": "motions", "outside": [], "sentences": ["It protects."], "truth": "ellipse",
    "n_of_learned_earthquakes": 3, "unresolved": 4,
    "not_carried": [{"candidate": "theirs", "confidence": 0.99}],
}  # fmt: skip


def test_rates_of_criteria_are_printed_with_their_limits(capsys):
    flat = " ".join(re.sub(r"[│┃]", " ", print_result(capsys, show_rates, RATES)).split())
    for words in (
        "events: 60 motions of 20 earthquakes, RMS error 0.05 over the first 12 s",
        "ours 95 % 90.0 % (80.0 % … 95.0 %) 85.0 % 2.0 % none", "Judged on motions: It protects.",
        "3 of the motions are of earthquakes that the suite holds", "theirs at 99 % is not judged",
        "reaches beyond the stored results: 4 times", "the motions' own ellipses decide",
    ):  # fmt: skip
        assert words in flat, words
    plain = {**RATES, "n_of_learned_earthquakes": 0, "unresolved": 0, "not_carried": [], "truth": "simulated"}
    flat = " ".join(print_result(capsys, show_rates, plain).split())
    for words in ("suite holds", "not judged", "Not judged", "own ellipses", "leads"):
        assert words not in flat
    assert "early (leads)" in print_result(capsys, show_rates, {**RATES, "rows_lead": RATES["rows"]})


def demand_of(**fields):
    return SimpleNamespace(refuse_all_but=lambda *_names: None, json_target=None, **fields)


def test_records_are_said_to_be_sound_or_not_with_the_reasons(capsys, monkeypatch):
    faults = {"a.nc": [], "b.nc": ["No rate.", "No units."]}
    monkeypatch.setattr(
        "reliab.app.api.records.check_records", lambda sources: {name: faults[name] for name in sources}
    )
    assert print_result(capsys, _check, demand_of(sources=["a.nc"])) == "a.nc: a valid record\n"
    with pytest.raises(Exception, match="1"):
        _check(demand_of(sources=["a.nc", "b.nc"]))
    output = capsys.readouterr().out
    assert output == "a.nc: a valid record\nb.nc: not a valid record\n  No rate.\n  No units.\n"


@pytest.mark.parametrize("target", [None, "-"])
def test_an_exported_monitor_is_printed_or_given_as_json(capsys, target):
    contents = SimpleNamespace(
        path="out", files=["a.c", "a.h"], to_dict=lambda: {"path": "out", "files": ["a.c", "a.h"]}
    )
    demand = SimpleNamespace(json_target=target, ask=lambda *_arguments, **_named: contents)
    text = print_result(capsys, _export, demand)
    if target is None:
        assert text == "Written to out: a.c, a.h\n"
    else:
        assert '"path": "out"' in text
        assert "Written to" not in text


def size(value, remaining):
    return {"value": value, "low": 0.5 * value, "high": 2.0 * value, "rms": value, "remaining_rms": remaining}


DEGREE = {
    "judged": True, "rms": size(0.0123, 0.0), "mte": size(0.0345, 0.0), "probability": 0.87,
    "parts": {"actuator_1_gain": {"rms": 0.0111}, "actuator_2_delay": {"rms": 0.0022}},
}  # fmt: skip
DISPLACEMENTS = {
    "budget": [
        {
            "quantity": "damping ratio", "size": 15.0, "unit": "%", "source": "default",
            "contribution": 0.0123, "remedy": "Measure it.",
        }
    ],
    "metric": "rms", "threshold": 0.01, "probability": 0.02,
    "verdict": "not_reliable", "reasons": ["First of all this.", "It exceeds the threshold."],
    "would_decide": ["a longer test"], "structure": "corner", "warnings": ["Look at this."],
    "notes": ["A remark."],
    "recording": {"channels": [{"channel": "command", "column": "u", "unit": "mm", "reason": "its name"}]},
    "error": {
        "degrees_of_freedom": {"x": DEGREE, "theta": {"judged": False, "parts": {}}}, "governing": "x",
        "improve_first": "actuator_1_gain", "rms": DEGREE["rms"], "mte": DEGREE["mte"],
        "parts": {
            "actuator_1_gain": {"remaining_rms": 0.0044}, "actuator_2_delay": {"remaining_rms": 0.0099},
        },
    },
    "actuators": [{"name": "1", "A": 0.98765, "d_ms": 2.345}, {"name": "2", "A": 1.01234, "d_ms": -0.567}],
    "critical_delay_ms": 12.34, "critical_direction": {"x": 0.9, "theta": 0.43},
    "critical_frequency_hz": 3.21, "stability_margin": 0.812,
}  # fmt: skip


def lines_of(text):
    return [" ".join(re.sub(r"[│┃]", " ", line).split()) for line in text.splitlines()]


def test_a_test_with_several_actuators_is_shown_by_degree_of_freedom(capsys):
    show_briefly(DISPLACEMENTS, omits_details=True)
    show_degrees(DISPLACEMENTS)
    lines = lines_of(capsys.readouterr().out)
    for line in (
        "NOT RELIABLE: RMS error of x 1.2 %, 2 % likely to be below 1 %", "First of all this.",
        "Next step: a longer test",
        "Error of corner, with 90 % intervals", "theta not judged", "Warning: Look at this.",
        "Improve first: gain of actuator 1; without it the RMS error of x would be 0.4 %.",
        "Tracking: actuator 1 A = 0.9877, d = 2.35 ms; actuator 2 A = 1.0123, d = -0.567 ms.",
        "1 note: run with --details.",
    ):  # fmt: skip
        assert line in lines, line
    (row,) = [line for line in lines if line.startswith("x ")]
    assert row.endswith(" 0.87")
    assert row.index(" 1.2 %") < row.index(" 3.")
    assert not any("Note" in line or "each part" in line for line in lines)


def test_tests_added_to_a_rig_are_printed_with_failures(capsys):
    row = {
        "name": "t1", "sha256": "0123456789abcdef", "date": "2026-01-02T10:00:00", "event": "Kobe",
        "A": 0.98765, "d_ms": 2.345, "remainder": 0.0123, "rms": 0.0456, "verdict": "not_reliable",
        "change": "delay",
    }  # fmt: skip
    content = {
        "rig": "r", "added": [row, {**row, "name": "t2", "rms": None, "change": None}], "tests": 7,
        "present": ["a.csv", "b.csv"], "faults": {"c.csv": "no column"},
    }  # fmt: skip
    show_added(content)
    lines = lines_of(capsys.readouterr().out)
    for line in (
        "Tests added to r: 2", "Tests in the rig: 7.", "Already in the rig: a.csv, b.csv.",
        "Not judged: c.csv: no column",
        "t1 01234567 2026-01-02 Kobe 0.9877 2.35 0.0123 4.6 % not reliable delay",
        "t2 01234567 2026-01-02 Kobe 0.9877 2.35 0.0123 not reliable",
    ):  # fmt: skip
        assert line in lines, (line, lines)
    show_added({**content, "added": [], "present": [], "faults": {}})
    assert lines_of(capsys.readouterr().out) == ["Tests added to r: 0.", "Tests in the rig: 7."]
