"""What `reliab assess` answers: about one test all that is found, about several a table."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.cli.assess.shown_frame import show_frame
from reliab.cli.assess.shown_test import show_assessment
from reliab.cli.output import console, progress_bar, table, write_json
from reliab.encodings import as_cell
from reliab.errors import InputError
from reliab.files import written_whole
from reliab.significant import significant
from reliab.vocabulary import PERCENT

if TYPE_CHECKING:
    from reliab.assessment import Assessment, Assessments, FrameAssessment
    from reliab.cli.assess.filed_report import Report

_COLUMNS = {
    "test": "left",
    "verdict": "left",
    "error": "right",
    "90 % interval": "right",
    "probability": "right",
    "A": "right",
    "d, ms": "right",
}


def answer(
    tests: list[Path],
    asked: dict[str, Any],
    *,
    out: Path | None,
    json_target: str | None,
    report: "Report | None",
    say: Callable[[str], str],
) -> bool:
    """Judge tests; write and print what is found."""
    from reliab.api import assess, unused

    if len(tests) == 1:
        assessment = assess(tests[0], **asked)
        _answer_one(assessment, tests[0], out, json_target)
        if report is not None:
            report.write(assessment, test=tests[0], structure=asked.get("structure"))
        return bool(assessment.reliable)
    if report is not None:
        raise unused("report", "beside several tests, since it is the report of one")
    with progress_bar("tests") as progress:
        assessments = assess(tests, **asked, progress=progress)
    _answer_several(assessments, out, json_target, say)
    return assessments.reliable


def _answer_one(
    assessment: "Assessment | FrameAssessment", test: Path, out: Path | None, json_target: str | None
) -> None:
    from reliab.assessment import Assessment

    content = assessment.to_dict()
    _write_table(out, [{"file": str(test), **content}])
    if write_json(content, json_target):
        return
    if isinstance(assessment, Assessment):
        show_assessment(assessment)
    else:
        show_frame(assessment)


def _answer_several(
    assessments: "Assessments", out: Path | None, json_target: str | None, say: Callable[[str], str]
) -> None:
    contents = [
        {"file": file, **({"fault": say(content["fault"])} if "fault" in content else content)}
        for file, content in assessments.to_dict().items()
    ]
    _write_table(out, contents)
    if not write_json(contents, json_target):
        _show(contents)
    if assessments.faults:
        raise InputError(
            "Every file must be a test that can be judged",
            value=f"{len(assessments.faults)} of {len(contents)} not judged: {', '.join(assessments.faults)}",
            remedy="Mend them as the reasons say, or leave them out; the others are answered",
        )


def _write_table(out: Path | None, contents: list[dict[str, Any]]) -> None:
    if out is None:
        return
    from reliab.assessment.verdict_table import verdict_table

    try:
        with written_whole(out) as file:
            rows = verdict_table(contents)
            rows.assign(file=rows["file"].map(as_cell)).to_csv(file, index=False)
    except OSError as error:
        raise InputError(
            "The table's file must be writable",
            value=error.strerror,
            remedy="Name another file",
            where=str(out),
        ) from error


def _show(contents: list[dict[str, Any]]) -> None:
    judged = [content for content in contents if "fault" not in content]
    asked = (
        f", {judged[0]['metric'].upper()} against {significant(PERCENT * judged[0]['threshold'])}%"
        if judged
        else ""
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
    from reliab.assessment import probability_text

    error = content["error"][content["metric"]]
    return [
        content["file"],
        content["verdict"].replace("_", " "),
        f"{error['value']:.2%}",
        f"{PERCENT * error['low']:.2f} … {error['high']:.2%}",
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
