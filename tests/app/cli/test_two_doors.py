"""The command and the function of Python give one answer, or refuse for one reason in their own words."""

import ast
import inspect
import json
import random
import re
from pathlib import Path

import numpy as np
import pytest
import typer
from parsed import nodes

import reliab
from reliab.app import cli, questions
from reliab.app.api import assessment
from reliab.app.cli.commands import as_options
from reliab.criterion.criterion import Criterion
from reliab.motions.loading import read_motion
from reliab.simulation.frames.frame_file import read_frame
from reliab.simulation.hybrid_test.model_file import read_model

DRAWS = 200
COMMAND = typer.main.get_group(cli.application())
TERMINAL_OPTIONS = {
    *("report", "title", "date", "paper", "laboratory", "logo"),
    *("out", "corrected", "details", "check", "json_target", "help"),
}
TESTS = [
    *[["test.csv"]] * 16,
    *(["stated.csv"], ["stated.csv"], ["whole.csv"], ["bare.csv"], ["ms.csv"], ["bar.csv"], ["missing.csv"]),
    *(["test.csv", "stated.csv"], ["stated.csv", "bare.csv", "missing.csv"], ["test.csv", "test.csv"], []),
]
CHOICES = {
    "f": (*[1.0] * 8, 1, "1±0.01", "1+-1%", 0.9, "one", "nan", -1, 0, "1±"),
    "xi": (*[0.02] * 8, 0.05, "0.02±0.002", 2, "x", 0, -0.02),
    "alpha": (0.5, 1, "0.9±0.1", 1.5, "half"),
    "scale": (1.003, "1±0.005", 0, -1, "big"),
    "feedback_lag": (0.5, "0.5±0.1", 0, -1, "late"),
    "mass": (2, "2±0.1", 0),
    "skew": (0.1, "-0.1±0.05", "soon"),
    "command_scale": (1.001, "1±0.001", 0),
    "hysteresis": (0.001, "0.001±0.0003", 0, -0.1),
    "resolution": (0.01, 0),
    "filter": (["measured=100"], ["measured=100/4", "command=200"], ["both=100"], ["command=-1"]),
    "equipment": ("equipment.toml", "missing.toml", "model.toml"),
    "exact": (True,),
    "motion": ("ground.txt", "missing.txt", "criterion.json"),
    "criterion": ("criterion.json", "missing.json", "test.csv"),
    "model": ("model.toml", "missing.toml", "frame.toml"),
    "structure": ("frame.toml", "missing.toml", "model.toml"),
    "threshold": (0.03, 0.05, 5.0, 0.0, float("nan")),
    "confidence": (0.8, 95.0, float("nan")),
    "metric": ("rms", "mte", "peak"),
    "command": ("other_m", "nothing"),
    "measured": ("other_m", "nothing"),
    "time": ("slow_s", "nothing"),
    "rate": (128.0, 100.0, 0.0, -5.0, float("inf")),
    "units": ("mm", "furlong"),
    "time_units": ("ms", "h"),
    "delimiter": ("|", ";"),
    "test_name": ("1", "other"),
    "channels": ("missing.toml", "frame.toml"),
    "specimen": ("linear", "measured", "elastic"),
    "force_channel": (["lag_ms=2±0.5"], ["attached_kg=12±1", "friction_n=40±20"], ["mass=2"]),
}
OFTEN = {"f": 0.9, "xi": 0.7, "test_name": 0.02, "channels": 0.02, "specimen": 0.02, "force_channel": 0.02}


class Answer:
    """What reaches the numerical rooms, in place of their answer."""

    reliable = True

    def __init__(self, recording, *given, **stated):
        self.content = {
            "recording": [float(np.sum(values)) for values in (recording.command, recording.measured)],
            "step": recording.time_step,
            "asked": [repr(given), *(f"{name} = {value!r}" for name, value in sorted(stated.items()))],
        }

    def to_dict(self):
        return self.content


@pytest.fixture(scope="module")
def folder(folder_of_a_test):
    text = (folder_of_a_test / "test.csv").read_text(encoding="utf-8")
    header = "# f = 1 ± 0.02 Hz\n# xi = 0.03\n# scale = 1.001\n"
    (folder_of_a_test / "stated.csv").write_text(header + text, encoding="utf-8")
    (folder_of_a_test / "equipment.toml").write_text("xi = 0.05\n", encoding="utf-8")
    return folder_of_a_test


def draw_question(number):
    """Draw files of tests and arguments; most are valid, some are not, and some do not go together."""
    dice = random.Random(number)  # noqa: S311
    terms = {
        name: dice.choice(values) for name, values in CHOICES.items() if dice.random() < OFTEN.get(name, 0.05)
    }
    return dice.choice(TESTS), terms


def ask_command(capsys, tests, stated):
    flags = {name: f"--{name.replace('_', '-')}" for name in stated} | {"test_name": "--test"}
    options = [
        text
        for name, value in stated.items()
        for row in (value if isinstance(value, list) else [value])
        for text in (flags[name], *([] if row is True else [str(row)]))
    ]
    code = cli.run(["assess", *tests, *options, "--json", "-"])
    out, err = capsys.readouterr()
    return code, json.loads(out) if out else None, err.strip()


def ask_python(tests, stated):
    """Answer in Python as the command does."""
    try:
        answer = reliab.assess(tests[0] if len(tests) == 1 else tests, **stated)
    except reliab.InputError as error:
        return 2, None, f"Error: {as_options(str(error), COMMAND)}"
    if len(tests) == 1:
        return 0, answer.to_dict(), ""
    contents = [
        {
            "file": file,
            **{key: as_options(value, COMMAND) if key == "fault" else value for key, value in _.items()},
        }
        for file, _ in answer.to_dict().items()
    ]
    return (2 if answer.faults else 0), contents, ""


def agree(capsys, tests, stated):
    code, content, sentence = ask_command(capsys, tests, stated)
    reference = ask_python(tests, stated)
    assert (code, content) == reference[:2], (tests, stated)
    if content is None:
        assert sentence == reference[2], (tests, stated)
        assert "`" not in sentence.replace("`reliab", "").replace(" --", "") or "`reliab" in sentence
    return code


@pytest.mark.slow
def test_drawn_inputs_reach_the_numerical_rooms_as_one(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    monkeypatch.setattr(assessment, "assess_recording", Answer)
    codes = [agree(capsys, *draw_question(number)) for number in range(DRAWS)]
    assert codes.count(0) > 0.2 * DRAWS
    assert codes.count(2) > 0.2 * DRAWS


@pytest.mark.slow
def test_drawn_inputs_are_answered_as_one(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    for number in range(150):
        agree(capsys, *draw_question(1000 + number))


@pytest.mark.default_cases(2)
@pytest.mark.parametrize("number", range(6))
def test_a_drawn_input_is_answered_as_one(folder, monkeypatch, capsys, number):
    monkeypatch.chdir(folder)
    values = (
        {"f": 1, "xi": 0.02},
        {"f": 1},
        {"f": 2, "xi": 0.05, "model": "model.toml"},
        {"model": "model.toml", "scale": 1.003},
        {"structure": "frame.toml", "metric": "mte"},
        {"f": 1, "xi": 0.02, "threshold": 5},
    )[number]
    assert agree(capsys, ["test.csv"], values) == (2 if number in (2, 5) else 0)


def test_objects_answer_like_their_files(folder, monkeypatch):
    monkeypatch.chdir(folder)
    monkeypatch.setattr(assessment, "assess_recording", Answer)
    readers = {
        "criterion": ("criterion.json", Criterion.read),
        "model": ("model.toml", read_model),
        "motion": ("ground.txt", read_motion),
        "structure": ("frame.toml", read_frame),
    }
    for name, (file, read) in readers.items():
        remainder = {} if name == "structure" else {"f": 1, "xi": 0.02}
        object_answer = reliab.assess("test.csv", **{name: read(file)}, **remainder)
        file_answer = reliab.assess("test.csv", **{name: file}, **remainder)
        assert object_answer.content["recording"] == file_answer.content["recording"]
        assert [text[:60] for text in object_answer.content["asked"]] == [
            text[:60] for text in file_answer.content["asked"]
        ]


def test_every_option_is_an_argument_and_every_argument_an_option():
    options = {parameter.name for parameter in COMMAND.commands["assess"].params} - TERMINAL_OPTIONS
    arguments = set(inspect.signature(reliab.assess).parameters)
    assert options - {"tests"} == arguments - {"test", "progress"} == set(CHOICES)
    names = set(questions.AssessmentQuestion.__annotations__)
    assert names == arguments - {"test", "structure", "progress"}


def test_an_unknown_argument_is_refused():
    with pytest.raises(TypeError, match="error_window"):
        reliab.assess("sample_test", f=1, xi=0.02, error_window=3)


def sentences(path):
    """Yield the texts of a module that are no docstrings."""
    docstrings = {
        id(node.body[0].value)
        for node in nodes(path)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
        and node.body
        and isinstance(node.body[0], ast.Expr)
    }
    for node in nodes(path):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            yield node.value


@pytest.mark.slow
def test_rooms_below_the_command_line_name_no_options():
    """An option stands in a command quoted as a whole; what both doors have is named in backquotes."""
    package = Path(reliab.__file__).parent
    stray = [
        (path.relative_to(package), text)
        for path in package.rglob("*.py")
        if "cli" not in path.relative_to(package).parts[:2] and path.name != "command.py"
        if path.parent.name != "app"  # which declares them
        for text in sentences(path)
        if re.search(r"(?<![-\w])--[a-z]", re.sub(r"`reliab [^`]*`|\breliab [a-z]+ .*", "", text))
    ]
    assert stray == []
