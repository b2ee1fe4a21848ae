"""`reliab rig`: the tests of a rig come, are listed, shown and removed; what they teach is asked."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import typer

from reliab.app import options, questions
from reliab.app.cli.commands import Command, Group, Request, takes
from reliab.app.cli.output import console, progress_bar, say, show_rows, write_json, write_line
from reliab.core.errors import InputError
from reliab.core.significant_digits import percent

if TYPE_CHECKING:
    from reliab.app.api.rigs import RigPrediction

app = typer.Typer(
    cls=Group, no_args_is_help=True, help="Store a rig's tests, predict the next one and detect drift."
)


@app.command("add", cls=Command)
@takes(questions.AddedTestQuestion, questions.RIG, questions.NEW_TESTS)
def add(request: Request) -> None:
    """Judge tests and keep them: record, verdict and indices."""
    from reliab.app.api.rigs import add_to_rig

    with progress_bar("tests") as progress:
        outcome = request.ask(add_to_rig, progress=progress)
    content = outcome.to_dict()
    content["faults"] = {file: request.write_as_options(fault) for file, fault in content["faults"].items()}
    if not write_json(content, request.json_target):
        show_added(content)
    if outcome.faults:
        raise InputError(
            f"Some files could not be judged: {', '.join(outcome.faults)}",
            remedy="Correct them as stated above, or leave them out; the other tests are in the rig",
        )


@app.command("list", cls=Command)
@takes(questions.RIG)
def list_tests(request: Request) -> None:
    """List the tests of a rig and say where it changed."""
    from reliab.app.api.rigs import list_rig

    request.answer(list_rig, lambda result: show_list(result.to_dict()))


@app.command("show", cls=Command)
@takes(questions.RIG, questions.KEPT_TEST)
def show(request: Request) -> None:
    """Show all that is kept of a test."""
    from reliab.app.api.rigs import show_rig_test

    request.answer(show_rig_test, show_test, content=dict)


@app.command("remove", cls=Command)
@takes(questions.RIG, questions.KEPT_TESTS)
def remove(request: Request) -> None:
    """Remove tests from a rig."""
    from reliab.app.api.rigs import remove_from_rig

    request.answer(
        remove_from_rig,
        lambda names: write_line(f"Removed: {', '.join(names)}."),
        content=lambda names: {"removed": list(names)},
    )


@app.command("export", cls=Command)
@takes(questions.RIG, questions.RIG_TABLE)
def export(request: Request) -> None:
    """Write the table of a rig's tests as CSV."""
    from reliab.app.api.rigs import export_rig

    request.answer(
        export_rig,
        lambda tests: write_line(f"{tests} tests written to {request.out}"),
        content=lambda tests: {"out": str(request.out), "tests": tests},
    )


@app.command("predict", cls=Command)
@takes(questions.PredictionQuestion, questions.RIG, options.DETAILS)
def predict(request: Request) -> None:
    """Predict the next test: A, d and error with their intervals, and the probability that it is good."""
    from reliab.app.api.rigs import predict_rig

    request.answer(predict_rig, lambda result: show_prediction(result, details=request.details), "details")


@app.command("report", cls=Command)
@takes(questions.RigReportQuestion, options.Cover, questions.RIG, questions.RIG_PDF)
def report(request: Request) -> None:
    """Write two pages on what the rig does and what to expect of its next test, and an appendix.

    What you leave out of the next test is taken from the last one.
    """
    from reliab.app.api.rigs import report_rig

    request.answer(
        report_rig,
        lambda path: write_line(f"Report: {path}"),
        *options.Cover.__annotations__,
        content=lambda path: {"report": str(path)},
        setting=request.setting(),
    )


_LAST = 40
_NEXT = {
    "amplitude": "correct the gain of the actuator",
    "delay": "compensate the delay better",
    "remainder": "look for friction, play or saturation, for instance by `reliab diagnose`",
}


def show_added(content: Mapping[str, Any]) -> None:
    """Say what became of the files."""
    _show_rows(f"Tests added to {content['rig']}: {len(content['added'])}", content["added"])
    _say(f"Tests in the rig: {content['tests']}.")
    if content["present"]:
        _say(f"Already in the rig: {', '.join(content['present'])}.")
    for file, fault in content["faults"].items():
        _say(f"Not judged: {file}: {fault}")


def show_list(content: Mapping[str, Any]) -> None:
    """Print the last tests; JSON and the exported table hold all."""
    rows = content["tests"]
    last = rows[-_LAST:]
    title = f"Tests of {content['rig']}: {len(rows)}"
    _show_rows(title if len(last) == len(rows) else f"{title}, the last {len(last)}", last)
    for file, fault in content["faults"].items():
        _say(f"Left out: {file}: {fault}")


def show_test(content: Mapping[str, Any]) -> None:
    """Print a test with what was stated and found."""
    test = content["test"]
    _show_rows(test["name"], [test])
    terms = ", ".join(f"{name} {text}" for name, text in content["terms"].items())
    _say(f"Stated: {terms or 'nothing'}.")
    for reason in content["assessment"].get("reasons", []):
        _say(reason)
    _say(f"Record: {content['record']}")


def _show_rows(title: str, rows: list[dict[str, Any]]) -> None:
    if not rows:
        _say(f"{title}.")
        return
    from reliab.app.api.rigs import RigList

    show_rows(title, RigList.table_columns, rows)


def show_prediction(result: "RigPrediction", *, details: bool) -> None:
    """Print what is predicted of the next test; with `details` also whether it can be relied on."""
    from reliab.report.kinds.rig_report import diagnostics_blocks, next_test_blocks
    from reliab.report.terminal import print_blocks

    prediction = result.prediction
    _say(
        f"The next test of {result.rig}, from {prediction.tests} tests of {prediction.earthquakes} "
        f"earthquakes: probability {prediction.probability:.2f} that its error stays below "
        f"{percent(prediction.threshold)}."
    )
    table, *comments = next_test_blocks(prediction)
    if details:
        print_blocks((table, *comments, *diagnostics_blocks(prediction)), console())
    else:
        print_blocks((table,), console())
        _say("Where the prediction comes from: run with --details.")
    first, share = max(prediction.drivers.items(), key=lambda item: item[1])
    _say(f"Next step: {_NEXT[first]}; {percent(share, 2)} of the error's square comes from the {first}.")


def _say(text: str) -> None:
    say(text, soft_wrap=True)
