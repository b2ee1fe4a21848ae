"""Each line and cell on the terminal stands for what its row holds, in the column of its heading."""

import re

import pytest

from reliab.app.cli.calibrate import _cells
from reliab.app.cli.criterion import show_criteria
from reliab.app.cli.motions import _path_within_sources, _show_faults, _show_notes
from reliab.core.stated_value import StatedValue
from reliab.motions.faults import Fault


@pytest.fixture(autouse=True)
def wide(monkeypatch):
    """A terminal on which no cell is broken."""
    monkeypatch.setenv("COLUMNS", "400")


ROW = {
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
    show_criteria({"criteria": rows, "posteriors": posteriors})
    return capsys.readouterr().out


def test_a_criterion_is_a_row_in_the_order_of_its_headings(capsys):
    text = print_criteria(capsys, [ROW, {**ROW, "f": 2.5, "lead_limit_ms": None, "confidence": None}])
    lines = [line.split() for line in text.splitlines()]
    first, second = (line for line in lines if line and line[0] in {"1.25", "2.5"})
    assert first == ["1.25", "0.03", "0.75", "0.04", "0.9", "0.000111", "2.22", "0.0333", "4.44", "5.55"]
    assert (second[4], second[-1]) == ("none", "-")
    for sentence in (
        "from 61 motions of 17 earthquakes", "Valid for ground motions like these: M 6 to 7.",
        "few earthquakes",
        "Method: dirichlet, a and b together. Law: none.",
        "Share α of the stiffness in the laboratory: 0.75.",
        "Window: record.",
    ):  # fmt: skip
        assert sentence in text
    assert "The case asked for lies" not in text


@pytest.mark.parametrize("joint", [True, False])
def test_a_population_elsewhere_and_separate_limits_are_told(capsys, joint):
    text = print_criteria(capsys, [{**ROW, "position": "outside", "joint": joint}])
    assert "The case asked for lies outside of these motions." in text
    assert ("a and b together" in text) is joint
    baseline = print_criteria(capsys, [{**ROW, "population": "", "warnings": []}])
    assert "Valid for ground motions like these" not in baseline
    assert "Note:" not in baseline


@pytest.mark.parametrize("converged", [True, False])
def test_a_posterior_says_whether_it_has_converged(capsys, converged):
    complaint = [] if converged else ["R-hat of mean is 1.2"]
    text = print_criteria(capsys, [ROW], [{**POSTERIOR, "converged": converged, "complaints": complaint}])
    title = "Posterior at 0.04 of rms: 4 ensembles of 32 walkers, 900 steps, 31 % of the moves accepted"
    assert title in " ".join(text.split())
    assert ("Converged:" in text) is converged
    assert ("THIS POSTERIOR HAS NOT CONVERGED." in text) is not converged
    assert ("R-hat of mean is 1.2" in text) is not converged


def test_every_fault_has_its_file_line_rule_value_and_remedy(capsys):
    faults = [
        Fault(file="/records/a.at2", line=7, rule="A rule", value="1 value", remedy="A remedy"),
        Fault(file="/records/b.at2", line=None, rule="Another", value="2 values", remedy="None"),
    ]
    _show_faults(faults, 9, ["/records"])
    text = capsys.readouterr().out
    assert "2 faults in 2 files" in text
    assert [re.split(r" {2,}", line.strip()) for line in text.splitlines() if "at2" in line] == [
        ["a.at2", "7", "A rule", "1 value", "A remedy"],
        ["b.at2", "Another", "2 values", "None"],
    ]
    _show_notes(faults[:1], ["/records"])
    assert capsys.readouterr().out == "Note: a.at2: 1 value. A remedy.\n"
    _show_faults([], 9, ["/records"])
    assert capsys.readouterr().out == "9 records, no faults.\n"


def test_files_elsewhere_keep_their_whole_path():
    assert _path_within_sources("/elsewhere/a.at2", ["/records"]) == "/elsewhere/a.at2"


def test_cells_of_a_calibration():
    assert _cells(None) == ("not determined", "")
    assert _cells(StatedValue(1.0025, 0.0005)) == ("1.0025", "0.0005")
