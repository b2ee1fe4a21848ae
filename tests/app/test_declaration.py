"""What a question declares of its arguments is what commands and functions of Python have."""

import inspect
import json
from typing import Annotated, TypedDict

import pytest
import typer

import reliab
from reliab.app import options, questions
from reliab.app.api.criteria import derive_criteria
from reliab.app.api.simulation import simulate_suite, trace_boundaries
from reliab.app.cli import application, run, spread
from reliab.app.cli.commands import takes
from reliab.app.declaration import Panel, Quantity, asks, collect_options, group
from reliab.core.stated_value import StatedValue

QUESTIONS = [
    item
    for module in (options, questions)
    for item in vars(module).values()
    if isinstance(item, type) and item.__module__ == module.__name__
]
COMMAND_FUNCTIONS = {item.__name__: item for item in (derive_criteria, simulate_suite, trace_boundaries)}
FUNCTIONS = {
    "assess": questions.AssessmentQuestion,
    "design_test": questions.DesignQuestion,
    "follow_test": questions.MonitorQuestion,
    "export_monitor": questions.LoopMonitorQuestion,
    "derive_criteria": questions.CriterionQuestion,
    "trace_boundaries": questions.TracingQuestion,
    "simulate_suite": questions.SimulationQuestion,
    "validate_criteria": questions.ValidationQuestion,
    "record": questions.RecordQuestion,
    "calibrate": questions.CalibrationQuestion,
    "add_to_rig": questions.AddedTestQuestion,
    "predict_rig": questions.PredictionQuestion,
    "import_motions": questions.MotionImportQuestion,
}


@group
class ExampleQuestion(TypedDict, total=False):
    """What is asked.

    load: Load [kg],
        beside `f`.
    steps: Number of steps.
    """

    load: Annotated[Quantity | None, Panel("Method").option("KG")]
    steps: Annotated[int, Panel("Method").advanced("N", default=3)]


@asks(ExampleQuestion)
def answer(name, *, late=0, **question):
    """Answer.

    Parameters
    ----------
    name : str
        Who asks.

    Returns
    -------
    tuple
        What was asked.
    """
    return name, late, question


def test_a_function_is_called_with_every_argument_and_numbers_without_their_unit():
    assert answer("a") == ("a", 0, {"load": None, "steps": 3})
    load = StatedValue(value=2.0, deviation=0.1)
    assert answer("a", load="2 kg ± 0.1 kg", late=1) == ("a", 1, {"load": load, "steps": 3})
    assert asks(ExampleQuestion, as_stated=True)(inspect.unwrap(answer))("a", load="2 kg")[2]["load"] == "2"


def test_an_unknown_argument_is_named_in_its_error():
    with pytest.raises(TypeError, match=r"answer\(\) has no argument lod"):
        answer("a", lod=2)


@pytest.mark.parametrize(
    "ask",
    [
        lambda: trace_boundaries(motions="synthetic", out="kept.csv"),
        lambda: reliab.write_explorer(out="kept.doc"),
        lambda: reliab.record("sample_test", csv="kept.nc"),
        lambda: derive_criteria(out="kept.toml"),
    ],
)
def test_a_file_of_another_kind_is_refused_in_python_too(ask):
    with pytest.raises(reliab.InputError, match="must end in"):
        ask()


def test_signature_and_docstring_follow_the_declaration():
    assert list(inspect.signature(answer).parameters) == ["name", "late", "load", "steps"]
    assert inspect.signature(answer).parameters["steps"].default == 3
    assert (
        "name : str\n    Who asks.\nload : float, str or StatedValue, optional\n    Load [kg]"
        in answer.__doc__
    )
    assert answer.__doc__.index("Number of steps.") < answer.__doc__.index("Returns")


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_public_function_documents_each_of_its_arguments_once(name):
    function = COMMAND_FUNCTIONS.get(name) or getattr(reliab, name)
    options_declared = collect_options(FUNCTIONS[name])
    assert set(options_declared) <= set(inspect.signature(function).parameters)
    for argument, (_, option) in options_declared.items():
        assert function.__doc__.count(f"\n{argument} : ") == 1
        assert option.help in function.__doc__


@pytest.mark.parametrize("question", QUESTIONS, ids=lambda question: question.__name__)
def test_a_name_has_one_flag_and_a_known_panel_and_unit(question):
    titles = {"", *(panel.title for panel in options.PANELS)}
    for name, (_, option) in collect_options(question).items():
        assert option.panel in titles, name
        assert option.help, name
        assert option.unit or "[" not in option.help, name
        assert option.metavar or option.default is False or option.names, name


def test_a_command_takes_a_declared_option():
    answers = []

    @takes(ExampleQuestion)
    def command(question):
        answers.append((question.steps, question.ask(answer, name="b")))

    app = typer.Typer()
    app.command()(command)
    typer.main.get_command(app).main(["--load", "2", "--steps", "4"], standalone_mode=False)
    assert answers == [(4, ("b", 0, {"load": StatedValue(value=2.0), "steps": 4}))]


EQUIVALENT = (
    ("design --frequency 1.5Hz 2Hz --damping 0.02", "design --f 1.5 2 --xi 0.02"),
    (
        "assess sample_test --f 1.0Hz±0.01Hz --xi 0.02",
        "assess --frequency 1.0±0.01 sample_test --damping 0.02",
    ),
    ("criterion --f 1Hz --xi 0.02", "criterion --ellipses real_suite --f 1 --xi 0.02"),
)


@pytest.mark.parametrize(("one", "other"), EQUIVALENT)
def test_two_ways_of_writing_a_question_have_one_answer(one, other, capsys):
    answers = []
    for command in (one, other):
        assert run([*command.split(), "--json", "-"]) == 0
        answers.append(json.loads(capsys.readouterr().out))
    assert answers[0] == answers[1]


def test_a_file_after_a_number_with_its_unit_is_no_number():
    command = typer.main.get_command(application())
    words = list(spread(["design", "--f", "1Hz", "2 Hz", "a.csv"], command))
    assert words == ["design", "--f", "1Hz", "--f", "2 Hz", "a.csv"]


def test_repeated_runs_are_extrapolated_as_the_same_test(tmp_path, monkeypatch, capsys):
    calls = []
    monkeypatch.setattr(
        "reliab.app.cli.assess._verdicts", lambda _, files, *_uses: calls.append(files) or Runs()
    )
    monkeypatch.chdir(tmp_path)
    assert run(["extrapolate", "a.csv", "b.csv", "--f", "1", "--check", "--json", "-"]) == 1
    assert json.loads(capsys.readouterr().out) == {"runs": 2}
    assert [path.name for path in calls[0]] == ["a.csv", "b.csv"]


class Runs:
    """Runs of one test, and what they say together."""

    reliable = False

    def same_test(self):
        return self

    def to_dict(self):
        return {"runs": 2}
