"""What `reliab assess` answers: about one test all that is found, about several a table."""

from pathlib import Path
from typing import Any

from reliab.cli.assess.demand import Demand
from reliab.cli.assess.judgement import Judge
from reliab.cli.output import console, progress_bar, table, write_json
from reliab.errors import InputError
from reliab.files import written_whole

_PERCENT = 100.0
_COLUMNS = {
    "test": "left",
    "verdict": "left",
    "error": "right",
    "90 % interval": "right",
    "probability": "right",
    "A": "right",
    "d, ms": "right",
}


def answer(demand: Demand, judge: Judge) -> bool:
    """Judge tests; write and print what is found.

    Parameters
    ----------
    demand : Demand
        What is asked.
    judge : callable
        Judges one test.

    Returns
    -------
    bool
        Whether every test is reliable.

    Raises
    ------
    InputError
        If no test is named or one cannot be judged; of several, after the others are answered.
    """
    if not demand.tests:
        raise InputError(
            "A test's file is needed",
            value="none",
            remedy="Name it, or ask what is tolerable with --design",
        )
    if len(demand.tests) == 1:
        return _answer_one(demand, judge)
    return _answer_several(demand, judge)


def _answer_one(demand: Demand, judge: Judge) -> bool:
    judgement = judge(demand.tests[0])
    _write_table(demand, [_named(demand.tests[0], judgement.content)])
    if not write_json(judgement.content, demand.json_target):
        judgement.show()
    judgement.write_report()
    return bool(judgement.content["reliable"])


def _answer_several(demand: Demand, judge: Judge) -> bool:
    contents = []
    with progress_bar("tests") as progress:
        for number, test in enumerate(demand.tests):
            progress(number, len(demand.tests))
            try:
                contents.append(_named(test, judge(test).content))
            except InputError as error:
                contents.append(_named(test, {"fault": str(error)}))
    _write_table(demand, contents)
    if not write_json(contents, demand.json_target):
        _show(contents)
    faulty = [content["file"] for content in contents if "fault" in content]
    if faulty:
        raise InputError(
            "Every file must be a test that can be judged",
            value=f"{len(faulty)} of {len(contents)} not judged: {', '.join(faulty)}",
            remedy="Mend them as the reasons say, or leave them out; the others are answered",
        )
    return all(content["reliable"] for content in contents)


def _named(test: Path, content: dict[str, Any]) -> dict[str, Any]:
    return {"file": str(test), **content}


def _write_table(demand: Demand, contents: list[dict[str, Any]]) -> None:
    if demand.out is None:
        return
    from reliab.validation.assessment.verdict_table import verdict_table

    try:
        with written_whole(demand.out) as file:
            verdict_table(contents).to_csv(file, index=False)
    except OSError as error:
        raise InputError(
            "The table's file must be writable",
            value=error.strerror,
            remedy="Name another file",
            where=str(demand.out),
        ) from error


def _show(contents: list[dict[str, Any]]) -> None:
    judged = [content for content in contents if "fault" not in content]
    asked = (
        f", {judged[0]['metric'].upper()} against {_PERCENT * judged[0]['threshold']:.3g}%" if judged else ""
    )
    shown = table(f"Verdicts on {len(contents)} tests{asked}", _COLUMNS)
    for content in contents:
        shown.add_row(*_row(content))
    terminal = console()
    terminal.print(shown)
    for content in contents:
        for sentence in _sentences(content):
            terminal.print(f"{content['file']}: {sentence}", highlight=False, markup=False)


def _row(content: dict[str, Any]) -> list[str]:
    if "fault" in content:
        return [content["file"], "not judged", *[""] * (len(_COLUMNS) - 2)]
    from reliab.validation.assessment.doubts import probability_text

    error = content["error"][content["metric"]]
    return [
        content["file"],
        content["verdict"].replace("_", " "),
        f"{error['value']:.2%}",
        f"{_PERCENT * error['low']:.2f} … {error['high']:.2%}",
        probability_text(content["probability"]),
        f"{content['A']:.5f}",
        f"{content['d_ms']:.4f}",
    ]


def _sentences(content: dict[str, Any]) -> list[str]:
    """Say below the table why a test is not reliable or not judged."""
    if "fault" in content:
        return [content["fault"].removeprefix(f"{Path(content['file']).name}: ")]
    warnings = [f"Warning: {warning}" for warning in content["warnings"]]
    return warnings if content["reliable"] else [*content["reasons"], *warnings]
