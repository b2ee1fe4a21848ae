"""What commands print of their results: each value in its place, each sentence where something is to say."""

import re
from types import SimpleNamespace

import pytest

from reliab.app.cli.assess.shown_briefly import show_briefly
from reliab.app.cli.assess.shown_frame import show_frame
from reliab.app.cli.criterion import _show_own_boundary
from reliab.app.cli.diagnose import _show
from reliab.app.cli.monitor import _export
from reliab.app.cli.record import _check
from reliab.app.cli.rig import show_added
from reliab.app.cli.validate import show_criteria as show_rates


@pytest.fixture(autouse=True)
def wide(monkeypatch):
    """A terminal on which no cell is broken."""
    monkeypatch.setenv("COLUMNS", "400")


def rows_of(text):
    """Cells of printed tables, row by row."""
    cells = [[cell.strip() for cell in re.split(r"[│┃|]", line)[1:-1]] for line in text.splitlines()]
    return [row for row in cells if len(row) > 1]


MODE = {"f_hz": 1.25, "xi": 0.03, "alpha": 0.4, "A": 0.9912, "d_ms": 1.234}
LENGTH = {"value": 1.234, "low": 1.1, "high": 1.3}
RESPONSE = {
    "name": "storey 2", "rms_mm": LENGTH, "peak_mm": {**LENGTH, "value": 2.345},
    "rms": {"value": 0.0123, "low": 0.01, "high": 0.02}, "mte": {"value": 0.0456, "low": 0.04, "high": 0.05},
}  # fmt: skip
BUDGET = [
    {
        "quantity": "damping ratio",
        "size": 15.0,
        "unit": "%",
        "source": "default",
        "contribution": 0.0123,
        "remedy": "Measure it.",
    },
]
FRAME = {
    "budget": BUDGET,
    "structure": "portal", "A": 0.9876, "d_ms": 2.345, "critical_delay_ms": 12.5, "stability_margin": 0.812,
    "by_index": {"index": 0.444, "verdict": "not_reliable"},
    "error": {"parts": {"delay": {"rms": 0.0321}}},
    "modes": [MODE, {**MODE, "f_hz": 3.5, "A": None, "d_ms": None}],
    "over_frequency": {"frequency_hz": [0.5, 2.0, 8.0], "error": {"rms": 0.0123, "remaining_rms": 0.0045}},
    "warnings": ["Look at this."], "notes": ["A remark."],
    "responses": {
        "unit": "mm",
        "each": [RESPONSE, {**RESPONSE, "name": "floor 1", "rms": None, "mte": None}],
        "in_words": "Of storeys.",
    },
    "recording": {"channels": [{"channel": "command", "column": "u", "unit": "mm", "reason": "its name"}]},
}  # fmt: skip


def show_all(content):
    show_frame(content, details=True)


def printed(capsys, show, *arguments):
    show(*arguments)
    return capsys.readouterr().out


def test_details_of_a_frame_stand_beside_their_names(capsys):
    text = printed(capsys, show_all, FRAME)
    lines = [" ".join(re.sub(r"[│┃]", " ", line).split()) for line in text.splitlines()]
    for line in (
        "Test of portal", "delay 3.21 %", "A 0.9876", "d 2.345 ms", "critical delay 12.500 ms",
        "stability margin 0.812", "index of the criterion 0.444: not reliable",
        "Tracking at the modes of the structure",
        "1 1.250 0.0300 0.400 0.9912 1.234", "2 3.500 0.0300 0.400 unknown unknown",
        "Errors of floors and storeys", "Of storeys.", "damping ratio 15 % default 1.23 %",
        "storey 2 1.23 (1.1 to 1.3) 2.35 (1.1 to 1.3) 1.23 % (1.00 to 2.00 %) 4.56 % (4.00 to 5.00 %)",
        "floor 1 1.23 (1.1 to 1.3) 2.35 (1.1 to 1.3) unknown unknown",
        "Warning: Look at this.", "Note: A remark.", "Channels: command = 'u' (mm; its name).",
        "A and d over frequency are known from 0.5 to 8 Hz and account for an RMS^R of 1.23 %; without them 0.45 % would remain.",  # noqa: E501
    ):  # fmt: skip
        assert line in lines, line


def test_a_frame_whose_numbers_are_not_known_says_so(capsys):
    unknown = {
        **FRAME, "critical_delay_ms": None, "stability_margin": None, "over_frequency": None,
        "by_index": {"index": None, "verdict": "undecided"},
    }  # fmt: skip
    text = printed(capsys, show_all, unknown)
    lines = [" ".join(re.sub(r"[│┃]", " ", line).split()) for line in text.splitlines()]
    assert {"critical delay none", "stability margin none"} <= set(lines)
    assert "index of the criterion unknown: undecided" in lines
    assert "over frequency" not in text
    without = printed(capsys, show_all, {**FRAME, "by_index": None})
    assert "index of the criterion" not in without


def test_the_boundary_of_a_motion_itself_is_a_row_for_each_structure(capsys):
    row = {"motion": "NGA_1", "f": 1.25, "xi": 0.03, "threshold": 0.04, "a": 1.11e-4, "b": 2.22}
    text = printed(capsys, _show_own_boundary, [row, {**row, "f": 2.5}])
    assert "Boundary of NGA_1 itself" in text
    numbers = [line.replace("│", " ").split() for line in text.splitlines() if "0.03" in line]
    assert numbers == [[f, "0.03", "0.04", "0.000111", "2.22"] for f in ("1.25", "2.5")]


def test_a_diagnosis_is_printed_with_its_places_unknowns_remarks_and_proof(capsys):
    finding = SimpleNamespace(
        block="specimen", kind="velocity_reversal", share_of_residual=0.37, chance="2e-04", test="t3",
        band=(0.5, 2.0), time=(3.0, 17.0), begin="1 mm, 20 mm/s",
    )  # fmt: skip
    gap = SimpleNamespace(
        conclusion="90 % closed", floor=0.0012, source="at rest", held_out=["t7", "t8"],
        channel="force_n", before=0.1111, after=0.0222, tests_after=[0.02, 0.03],
        by_test=[SimpleNamespace(files=["t8"], kind="sine", before=0.11, after=0.03)],
    )  # fmt: skip
    unknown = SimpleNamespace(block="specimen", expression="3 x³", description="a bent spring")
    fits = [SimpleNamespace(), SimpleNamespace()]
    block = SimpleNamespace(
        unknown=unknown, gap=gap, held_out="t7, t8", block=SimpleNamespace(block="specimen"), effects=(),
        doubtful=(), best=fits[0],
        candidates=[
            SimpleNamespace(fit=fit, names=names, left_out=0.04, held_out=0.02)
            for fit, names in zip(fits, (("hysteresis", "gap"), ()), strict=True)
        ],
    )  # fmt: skip
    diagnosis = SimpleNamespace(
        where=[finding], effects=(), doubtful=(), blocks=[block], remarks=["Nothing else."]
    )
    text = printed(capsys, _show, diagnosis)
    flat = " ".join(re.sub(r"[│┃]", " ", text).split())
    assert "Where the calibrated model fails" in text
    assert "specimen velocity reversal 37 % 2e-04 t3 0.5 to 2 3 to 17 1 mm, 20 mm/s" in flat
    assert "→ hysteresis + gap 0.0400 0.0200 calibration alone 0.0400" in flat
    assert "Unknown effect in the specimen: 3 x³" in text
    assert "Nothing else." in text
    assert (
        "held-out t7, t8, force_n: error over the signal's RMS 0.1111 before, 0.0222 after, "
        "noise 0.0012 (at rest); 90 % closed." in flat
    )
    assert "; 90 % closed. The least explained test" in flat
    assert "The least explained test is t8 (sine): 0.1100 before, 0.0300 after." in flat
    unknown.expression = ""
    assert "Unknown effect in the specimen: a bent spring" in printed(capsys, _show, diagnosis)


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


def test_rates_of_criteria_are_printed_with_what_limits_them(capsys):
    flat = " ".join(re.sub(r"[│┃]", " ", printed(capsys, show_rates, RATES)).split())
    for words in (
        "events: 60 motions of 20 earthquakes, RMS 0.05 over the first 12 s",
        "ours 95 % 90.0 % (80.0 % … 95.0 %) 85.0 % 2.0 % none", "Judged on motions: It protects.",
        "3 of the motions are of earthquakes that the suite holds", "theirs at 99 % is not judged",
        "reaches beyond the stored results: 4 times", "the motions' own ellipses decide",
    ):  # fmt: skip
        assert words in flat, words
    plain = {**RATES, "n_of_learned_earthquakes": 0, "unresolved": 0, "not_carried": [], "truth": "simulated"}
    flat = " ".join(printed(capsys, show_rates, plain).split())
    for words in ("suite holds", "not judged", "Not judged", "own ellipses", "leads"):
        assert words not in flat
    assert "early (leads)" in printed(capsys, show_rates, {**RATES, "rows_lead": RATES["rows"]})


def demand_of(**fields):
    return SimpleNamespace(refuse_all_but=lambda *_names: None, json_target=None, **fields)


def test_records_are_said_to_be_sound_or_not_with_the_reasons(capsys, monkeypatch):
    faults = {"a.nc": [], "b.nc": ["No rate.", "No units."]}
    monkeypatch.setattr(
        "reliab.app.api.records.check_records", lambda sources: {name: faults[name] for name in sources}
    )
    assert printed(capsys, _check, demand_of(sources=["a.nc"])) == "a.nc: a valid record\n"
    with pytest.raises(Exception, match="1"):
        _check(demand_of(sources=["a.nc", "b.nc"]))
    shown = capsys.readouterr().out
    assert shown == "a.nc: a valid record\nb.nc: not a valid record\n  No rate.\n  No units.\n"


@pytest.mark.parametrize("target", [None, "-"])
def test_an_exported_monitor_is_printed_or_given_as_json(capsys, target):
    written = SimpleNamespace(
        path="out", files=["a.c", "a.h"], to_dict=lambda: {"path": "out", "files": ["a.c", "a.h"]}
    )
    demand = SimpleNamespace(json_target=target, ask=lambda *_arguments, **_named: written)
    text = printed(capsys, _export, demand)
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
SEVERAL = {
    "budget": BUDGET,
    "responses": FRAME["responses"],
    "modes": [{**MODE, "A": None, "d_ms": None}], "metric": "rms", "threshold": 0.01, "probability": 0.02,
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


def shown_of_several(capsys, content, *, details):
    show_briefly(content, without_details=not details)
    show_frame(content, details=details)
    return lines_of(capsys.readouterr().out)


def test_a_test_with_several_actuators_is_shown_by_degree_of_freedom(capsys):
    lines = shown_of_several(capsys, SEVERAL, details=False)
    for line in (
        "NOT RELIABLE: RMS^R of x is 1.23 %, below 1 % with probability 0.02", "First of all this.",
        "Next step: a longer test",
        "Error of corner, with 90 % intervals", "theta not judged", "Warning: Look at this.",
        "Improve first: gain of actuator 1; without it RMS^R of x would be 0.44 %.",
        "Tracking: actuator 1 A = 0.9877, d = 2.35 ms; actuator 2 A = 1.0123, d = -0.567 ms.",
        "1 note: run with --details.",
    ):  # fmt: skip
        assert line in lines, line
    (row,) = [line for line in lines if line.startswith("x ")]
    assert row.endswith(" 0.87")
    assert row.index("1.23") < row.index("3.4")
    assert not any("Note" in line or "each part" in line for line in lines)


def test_details_of_a_test_with_several_actuators_are_its_parts_channels_and_notes(capsys):
    sentence = (
        "The critical delay is common to all actuators: with it the loop oscillates at 3.21 Hz in the motion "
    )
    lines = shown_of_several(capsys, SEVERAL, details=True)
    assert f"{sentence}x 0.9, theta 0.43." in lines
    assert {"critical delay 12.340 ms", "stability margin 0.812", "A of actuator 2 1.0123"} <= set(lines)
    assert "1 1.250 0.0300 0.400 unknown unknown" in lines
    calm = {
        **SEVERAL, "critical_delay_ms": None, "error": {**SEVERAL["error"], "improve_first": None},
    }  # fmt: skip
    lines = shown_of_several(capsys, calm, details=True)
    assert "RMS^R of each part of the error" in " ".join(lines)
    assert "gain of actuator 1 1.11 %" in lines
    assert "delay of actuator 2 0.22 %" in lines
    assert "damping ratio 15 % default 1.23 %" in lines
    assert "floor 1 1.23 (1.1 to 1.3) 2.35 (1.1 to 1.3) unknown unknown" in lines
    assert "Channels: command = 'u' (mm; its name)." in lines
    assert "Note: A remark." in lines
    assert "Improve first: no single part." in " ".join(lines)
    assert not any(line.startswith(("The critical delay", "All results")) for line in lines)


def test_tests_added_to_a_rig_are_shown_with_what_was_there_and_what_failed(capsys):
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
        "t1 01234567 2026-01-02 Kobe 0.9877 2.35 0.0123 4.56 % not reliable delay",
        "t2 01234567 2026-01-02 Kobe 0.9877 2.35 0.0123 not reliable",
    ):  # fmt: skip
        assert line in lines, (line, lines)
    show_added({**content, "added": [], "present": [], "faults": {}})
    assert lines_of(capsys.readouterr().out) == ["Tests added to r: 0.", "Tests in the rig: 7."]
