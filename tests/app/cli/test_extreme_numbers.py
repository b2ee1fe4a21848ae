"""Numbers that no structure or test has are refused in a sentence, without warnings of numerics."""

import warnings

import numpy as np
import pytest

from reliab.app.cli import run
from reliab.motions.catalogue import write_suite
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite

DESIGN = ("design",)
TEST = ("assess", "sample_test", "--f", "1", "--xi", "0.02")
ELLIPSES = ("ellipses", "--motions", "MOTIONS", "--f", "1", "--xi", "0.02")
OPTIONS = [
    *((DESIGN, option) for option in ("--f", "--xi", "--threshold", "--confidence")),
    *((TEST, option) for option in ("--f", "--xi", "--alpha", "--scale", "--feedback-lag", "--threshold")),
    *((ELLIPSES, option) for option in ("--f", "--xi", "--alpha", "--threshold", "--window")),
]
TINY = ("5e-324", "1e-320", "1e-300", "1e-160", "1e-40")
HUGE = ("1e40", "1e160", "1e308", "-1e-320", "-1e308", "nan", "inf")
MEANINGFUL = {"--confidence": TINY, "--window": ("1e40", "1e160", "1e308")}
"""A confidence near zero, and a window longer than the record, mean something."""


@pytest.fixture(scope="module")
def motions(tmp_path_factory):
    time = np.arange(0.0, 4.0, 0.02)
    motion = Motion(name="A", acceleration=np.sin(5.0 * time) * np.sin(np.pi * time / 4.0), time_step=0.02)
    folder = tmp_path_factory.mktemp("motions") / "suite"
    write_suite(MotionSuite.from_motions([motion]), folder)
    return folder


def replace_number(words, option, value, motions):
    words = [str(motions) if word == "MOTIONS" else word for word in words]
    if option in words:
        words[words.index(option) + 1] = value
        return words
    return [*words, option, value]


@pytest.mark.default_cases(60)
@pytest.mark.parametrize(
    ("words", "option", "value"),
    [
        (words, option, value)
        for words, option in OPTIONS
        for value in (*TINY, *HUGE)
        if value not in MEANINGFUL.get(option, ())
    ],
)
def test_an_impossible_number_is_refused(words, option, value, motions, tmp_path, capsys):
    arguments = replace_number(words, option, value, motions)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert run([*arguments, "--json", str(tmp_path / "answer.json")]) == 2
    message = capsys.readouterr().err
    assert "Traceback" not in message
    assert "Warning" not in message


EDGES = [
    *((TEST, "--xi", value) for value in ("1e-12", "1e-6")),
    (TEST, "--alpha", "1e-6"),
    *((TEST, "--scale", value) for value in ("0.001", "1000")),
    (TEST, "--feedback-lag", "1e-30"),
    *((DESIGN, "--f", value) for value in ("0.01", "1e4")),
    (DESIGN, "--xi", "1e-12"),
    (DESIGN, "--confidence", "5e-324"),
    *((ELLIPSES, "--threshold", value) for value in ("1e-6", "2")),
    *((ELLIPSES, "--xi", value) for value in ("1e-12", "1e-6")),
    (ELLIPSES, "--alpha", "1e-6"),
    (ELLIPSES, "--f", "0.01"),
]
"""The smallest and largest numbers that are not refused."""


@pytest.mark.slow
@pytest.mark.parametrize(("words", "option", "value"), EDGES)
def test_no_warning_of_numerics_reaches_the_screen(words, option, value, motions, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        response = run(
            [*replace_number(words, option, value, motions), "--json", str(tmp_path / "answer.json")]
        )
    assert response in (0, 1)
