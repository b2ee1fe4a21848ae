"""What a command prints without --details: the outcome first, ten lines at most, and what to do last."""

import pytest

from reliab.app.cli import run

STRUCTURE = ("--f", "1", "--xi", "0.02")
RIG_A = ("datasets/campaigns/rig_a/test_01.csv", "datasets/campaigns/rig_a/test_02.csv")
FEWEST_LINES, MOST_LINES = 5, 10
ANSWERS = {
    "assess": (("assess", "sample_test", *STRUCTURE), "RELIABLE: ", "To narrow the interval: "),
    "criterion": (("criterion", *STRUCTURE), "At 1 Hz, ξ = 0.02, 95 % of ", "Next step: judge a test"),
    "design": (
        ("design", "--f", "0.5", "1", "2"),
        "At 0.5 Hz, ξ = 0.02, 95 % of ",
        "Next step: judge a test",
    ),
    "calibrate": (("calibrate", "sample_test"), "What the measured channel adds", "Note: The skew includes"),
    "rig predict": (
        ("rig", "predict", "datasets/sample_rig", "--f", "1", "--xi", "0.03"),
        "The next test of datasets/sample_rig, from 126 tests of 42 earthquakes: probability 0.78 ",
        "Next step: compensate the delay better; 77 %",
    ),
    "diagnose": (("diagnose", "rig_a"), "rig_a: The model lacks coulomb friction.", "Next step: use "),
    "compare": (
        ("compare", *RIG_A, "--f", "1.384", "--xi", "0.0733"),
        "datasets/campaigns/rig_a/test_0",
        "Next step: ",
    ),
}
SLOW = ("compare", "diagnose")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in ANSWERS]
)
def test_answer_begins_with_the_outcome_and_ends_with_an_action(name, monkeypatch, request, capsys):
    monkeypatch.chdir(request.config.rootpath)
    command, first, last = ANSWERS[name]
    assert run(list(command)) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith(first)
    assert FEWEST_LINES <= len(lines) <= MOST_LINES
    assert any(line.startswith(last) for line in lines[-2:])
