"""What workers do for the pages: questions to the Python interface; answers as plain values and HTML."""

import base64
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import chdir
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from reliab.app.api.assessment import (
    assess,
    document_of_test,
    write_corrected,
    write_tests,
)
from reliab.app.api.diagnosis import diagnose_campaign, document_of_diagnosis
from reliab.app.api.monitor import follow_test
from reliab.app.api.records import record as api_record
from reliab.app.api.rigs import document_of_rig, export_rig, list_rig
from reliab.app.api.simulation import trace_boundaries
from reliab.assessment.assessment import Assessment
from reliab.assessment.comparison import rank_tests
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.files import write_json_file
from reliab.core.progress import show_task
from reliab.core.vocabulary import MILLI
from reliab.desk.jobs import Tell
from reliab.recordings.readers.registry import read_tests
from reliab.report.content import CONTENT_FILE, files_of
from reliab.report.document import Document
from reliab.report.kinds.comparison import comparison_report
from reliab.report.pdf import write_pdf
from reliab.report.prose import formula

if TYPE_CHECKING:
    from reliab.assessment.assess import AnyAssessment


_LOWEST_HEADING: Final = 6
_PIXELS: Final = 4.6  # of a screen for a millimetre of print


def document_html(document: Document, *, heading: int = 2) -> str:
    """Render a document below a heading of a level; every text of it is escaped."""
    return _Renderer(files_of(document), heading).html()


class _Renderer:
    """Renders the content of one document."""

    def __init__(self, files: Mapping[str, bytes], heading: int) -> None:
        self._content: dict[str, Any] = json.loads(files[CONTENT_FILE])
        self._files, self._heading = files, heading

    def html(self) -> str:
        content = self._content
        facts = "".join(f"<dt>{escape(name)}</dt><dd>{_prose(text)}</dd>" for name, text in content["facts"])
        parts = [
            f'<p class="verdict {escape(content["tone"])}">{_prose(content["verdict"])}</p>',
            f"<dl>{facts}</dl>" if facts else "",
            *self._blocks(content["leading"]),
            *self._blocks(content["blocks"]),
            *self._blocks(content["appendix"]),
        ]
        return f'<div class="document">{"".join(parts)}</div>'

    def _blocks(self, blocks: Sequence[Mapping[str, Any]]) -> Iterator[str]:
        for block in blocks:
            yield self._block(block)

    def _block(self, block: Mapping[str, Any]) -> str:
        match block["kind"]:
            case "section":
                level = min(self._heading + int(block["level"]) - 1, _LOWEST_HEADING)
                inner = "".join(self._blocks(block["blocks"]))
                return f"<h{level}>{escape(block['title'])}</h{level}>{inner}"
            case "points":
                return f"<ul>{''.join(f'<li>{_prose(item)}</li>' for item in block['items'])}</ul>"
            case "equation":
                return f"<p><i>{escape(formula(block['math']))}</i></p>"
            case "table":
                return _table(block)
            case "figure":
                svg, width = self._files[block["file"]], float(block["width"])
                return _picture(svg, width, block["alternative"], _prose(block["caption"]))
            case _:
                return f"<p>{_prose(block['text'])}</p>"


def _picture(svg: bytes, width: float, alternative: str, caption: str) -> str:
    """Show a drawing of a width [mm] as a picture, in which no script can run; the caption is HTML."""
    data = base64.b64encode(svg).decode()
    image = (
        f'<img alt="{escape(alternative)}" width="{_PIXELS * width:.0f}" '
        f'src="data:image/svg+xml;base64,{data}">'
    )
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"


def _prose(pieces: Sequence[Mapping[str, Any]]) -> str:
    return "".join(map(_piece, pieces))


def _piece(piece: Mapping[str, Any]) -> str:
    match piece["kind"]:
        case "math":
            return f"<i>{escape(formula(piece['source']))}</i>"
        case "strong":
            return f"<b>{escape(piece['text'])}</b>"
        case "source":
            return f"[{piece['number']}]"
        case "reference":
            return "the figure or table" if ":" in piece["label"] else escape(piece["label"])
        case _:
            return escape(piece["text"])


def _table(block: Mapping[str, Any]) -> str:
    groups = "".join(
        f'<th colspan="{int(group["span"])}">{_prose(group["heading"])}</th>' for group in block["groups"]
    )
    top = "".join(map(_heading, block["headings"]))
    rows = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in block["rows"])
    error_figure = f"<tr>{groups}</tr>" if groups else ""
    return (
        f'<div class="wide" tabindex="0" role="group" aria-label="Table"><table>'
        f"<caption>{_prose(block['caption'])}</caption>"
        f"<thead>{error_figure}<tr>{top}</tr></thead><tbody>{rows}</tbody></table></div>"
    )


def _heading(heading: Mapping[str, Any]) -> str:
    unit = f" [{escape(heading['unit'])}]" if heading["unit"] else ""
    return f'<th scope="col">{_prose(heading["heading"])}{unit}</th>'


def _cell(cell: Mapping[str, Any]) -> str:
    if "text" in cell:
        return f"<td>{escape(cell['text'])}</td>"
    power = "" if cell["exponent"] is None else f" × 10<sup>{int(cell['exponent'])}</sup>"
    return f'<td class="number">{escape(cell["digits"])}{power}</td>'


_POINTS: Final = 2000  # pairs of least and greatest value in which a history is drawn


@dataclass(frozen=True, kw_only=True, eq=False)
class Trace:
    """A history as it is drawn: no peak of it is lost."""

    name: str
    unit: str
    time: Array  # s
    values: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Look:
    """What was recognised in a file."""

    channels: Sequence[Mapping[str, Any]] = ()  # As of `reliab record`
    columns: tuple[str, ...] = ()
    tests: tuple[str, ...] = ()  # Names, where the file holds several
    traces: tuple[Trace, ...] = ()
    rate: float | None = None  # Hz
    notes: tuple[str, ...] = ()
    refusal: str = ""  # Why the channels could not be told from each other


def look_at(path: str, **arguments: Any) -> Look:  # noqa: ANN401 - those of `reliab.record`
    """Recognise the channels of a test; a file whose channels cannot be told still lists its columns."""
    columns_by_name = {columns.test: tuple(columns.series) for columns in read_tests(path)}
    has_several = len(columns_by_name) > 1
    first = next(iter(columns_by_name))
    name = arguments.get("test_name") or (first if has_several else None)
    look = Look(
        columns=columns_by_name.get(name or first, ()), tests=tuple(columns_by_name) if has_several else ()
    )
    try:
        record = api_record(path, **{**arguments, "test_name": name})
    except InputError as error:
        return replace(look, refusal=str(error))
    histories, content = record.histories, record.to_dict()
    traces = tuple(
        _trace(key, _UNITS.get(str(channel.part), ""), histories.values[key], histories.time_step)
        for key, channel in histories.channels.items()
        if key in histories.values
    )
    return replace(
        look,
        channels=content["recording"]["channels"],
        traces=traces,
        rate=content["rate_hz"],
        notes=tuple(content["notes"]),
    )


_UNITS: Final = {"command": "mm", "measured": "mm", "force": "N", "ground acceleration": "m/s²"}


def _trace(name: str, unit: str, values: Array, time_step: float) -> Trace:
    time, histories_drawn = thin_histories(
        time_step * np.arange(values.size, dtype=np.float64), values * (MILLI if unit == "mm" else 1.0)
    )
    return Trace(name=name, unit=unit, time=time, values=histories_drawn)


def thin_histories(time: Array, *values: Array) -> tuple[Array, ...]:
    """Keep least and greatest value of each stretch of the first history, and the others there.

    >>> thin_histories(np.arange(3.0), np.array([1.0, 5.0, 2.0]))[1].tolist()
    [1.0, 5.0, 2.0]
    """
    if time.size <= 2 * _POINTS:
        return (time, *values)
    length = -(-time.size // _POINTS)
    complete = np.pad(values[0], (0, -values[0].size % length), mode="edge").reshape(-1, length)
    begins = length * np.arange(complete.shape[0])
    places = np.unique(np.concatenate([begins + complete.argmin(axis=1), begins + complete.argmax(axis=1)]))
    places = places[places < time.size]
    return (time[places], *(history[places] for history in values))


@dataclass(frozen=True, kw_only=True)
class Mark:
    """A stretch of a test in which something is wrong."""

    begin: float  # s
    end: float  # s
    finding: str


@dataclass(frozen=True, kw_only=True, eq=False)
class Judgement:
    """The verdict on a test as its page shows it."""

    content: Mapping[str, Any]  # As of `reliab assess --json`
    # time [s], error, low, high [mm]; None where several displacements have errors
    histories: tuple[Array, Array, Array, Array] | None = None
    bound: float = 0.0  # Threshold times the peak of the exact response [mm]
    marks: tuple[Mark, ...] = ()
    contradictions: tuple[str, ...] = ()  # Sentences


@dataclass(frozen=True, kw_only=True)
class Filed:
    """What is kept of an answer: the page's details, and files by what they are called."""

    html: str
    files: Mapping[str, str]


def judge(test: str, folder: str, arguments: Mapping[str, Any], tell: Tell) -> Filed:
    """Judge a test; the verdict comes first, the report and the files follow."""
    with show_task("Rebuilding the error"):
        assessment = assess(test, **arguments)
    tell(judgement_of(assessment))
    return _file_report(assessment, test, folder, arguments.get("structure"))


def judgement_of(assessment: "AnyAssessment") -> Judgement:
    """Take what a page shows from an assessment."""
    plain = Judgement(content=assessment.to_dict(), contradictions=tuple(_contradictions(assessment)))
    if assessment.error.has_several:
        return plain
    rebuilt = assessment.error.displacements[0]
    time = assessment.recording.time_step * np.arange(rebuilt.error.size, dtype=np.float64)
    histories = (rebuilt.smooth_error, rebuilt.low, rebuilt.high)
    histories_drawn = thin_histories(time, *(MILLI * history for history in histories))
    return replace(
        plain,
        histories=(histories_drawn[0], histories_drawn[1], histories_drawn[2], histories_drawn[3]),
        bound=MILLI * assessment.error.threshold * float(np.abs(rebuilt.reference).max()),
        marks=tuple(_marks(assessment)),
    )


def _contradictions(assessment: "AnyAssessment") -> Iterator[str]:
    """Say what in the recording contradicts what is stated, or is faulty."""
    content = assessment.to_dict()
    yield from content["error"].get("contradictions", ())
    yield from (contradiction.finding for contradiction in assessment.contradictions)
    yield from (fault["finding"] for fault in content.get("faults", ()))


def _marks(assessment: "AnyAssessment") -> Iterator[Mark]:
    """Say where faults of the recording are; those of the whole test have no place."""
    if not isinstance(assessment, Assessment):
        return
    step = assessment.recording.time_step
    for effect in assessment.faults:
        fault = effect.fault
        for artefact in (fault.in_measured, fault.in_command):
            places = np.flatnonzero(artefact) if artefact is not None else np.zeros(0, dtype=int)
            if 0 < places.size < assessment.recording.command.size // 2:
                yield Mark(begin=step * places[0], end=step * (places[-1] + 1), finding=fault.finding)


def _file_report(assessment: "AnyAssessment", test: str, folder: str, structure: str | None) -> Filed:
    with show_task("Writing the report"):
        document = document_of_test(assessment, test=test, structure=structure)
        files = {"Report (PDF)": _pdf(document, folder)}
    place = Path(folder)
    write_json_file(assessment.to_dict(), place / "verdict.json")
    files["Numbers (JSON)"] = str(place / "verdict.json")
    write_corrected(assessment, place / "corrected.csv")
    files["Corrected response (CSV)"] = str(place / "corrected.csv")
    return Filed(html=document_html(document), files=files)


def _pdf(document: Document, folder: str) -> str:
    path = Path(folder) / "report.pdf"
    write_pdf(document, path, date=datetime.now(tz=UTC).date())
    return str(path)


def follow(source: str, folder: str, arguments: Mapping[str, Any], tell: Tell) -> Filed | None:
    """Follow a test while its file grows; the verdict is that of the whole test."""
    last = None
    with show_task("Following"):
        for last in follow_test(source, **arguments):
            tell({**last.to_dict(), "sentences": list(last.alarms.values())})
    if last is None or last.assessment is None:
        return None
    tell(judgement_of(last.assessment))
    return _file_report(last.assessment, source, folder, arguments.get("structure"))


def trace_motion(motion: str, **arguments: Any) -> dict[str, Any]:  # noqa: ANN401 - of `trace_boundaries`
    """Trace the boundary of equal error of a ground motion."""
    with show_task("Tracing the boundary"):
        boundaries = trace_boundaries(motions=motion, **arguments)
    return next(iter(boundaries.rows()))


def compare(tests: Sequence[str], folder: str, arguments: Mapping[str, Any]) -> Filed:
    """Rank tests of one folder by their errors; they are called by their names."""
    place = Path(folder)
    with chdir(Path(tests[0]).parent), show_task("Judging the tests") as progress:
        assessments = assess([Path(test).name for test in tests], **arguments, progress=progress)
    comparison = rank_tests(assessments.judged, assessments.faults)
    write_tests(comparison, place / "ranking.csv")
    write_json_file(comparison.to_dict(), place / "ranking.json")
    document = comparison_report(comparison)
    files = {
        "Report (PDF)": _pdf(document, folder),
        "Table (CSV)": str(place / "ranking.csv"),
        "Numbers (JSON)": str(place / "ranking.json"),
    }
    return Filed(html=document_html(document), files=files)


def show_rig(rig: str, folder: str, arguments: Mapping[str, Any]) -> Filed:
    """Show a rig's history, and predict its next test."""
    with show_task("Reading the rig's tests"):
        document = document_of_rig(rig, **arguments)
    table = Path(folder) / "tests.csv"
    export_rig(rig, table)
    files = {"Report (PDF)": _pdf(document, folder), "Table of its tests (CSV)": str(table)}
    return Filed(html=document_html(document), files=files)


def points_of_rig(rig: str) -> list[tuple[str, float, float]]:
    """List the tests of a rig with A [-] and d [ms]; those without are left out."""
    rows = list_rig(rig).to_dict()["tests"]
    points = (row for row in rows if None not in (row.get("A"), row.get("d_ms")))
    return [(str(row["name"]), float(row["A"]), float(row["d_ms"])) for row in points]


def diagnose(campaign: str, folder: str, tell: Tell) -> Filed:
    """Find what a campaign's model lacks; the statement comes first, posteriors and report follow."""
    addition = diagnose_campaign(
        campaign,
        out=folder,
        tell=lambda diagnosis: tell(f"{diagnosis.verdict}: {diagnosis.statement}"),
    )
    with show_task("Writing the report"):
        document = document_of_diagnosis(addition, campaign)
        files = {"Report (PDF)": _pdf(document, folder)}
    for name, file in {"Model (TOML)": "model.toml", "Numbers (JSON)": "diagnosis.json"}.items():
        if (Path(folder) / file).is_file():
            files[name] = str(Path(folder) / file)
    return Filed(html=document_html(document), files=files)
