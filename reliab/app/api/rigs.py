"""Tests of a rig: judged and kept in its folder, listed, exported and removed; and what they predict."""

import hashlib
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Unpack, cast

import numpy as np

from reliab.app import questions
from reliab.app.api.arguments import (
    STRUCTURE_NAMES,
    parse_threshold,
    refuse_stated,
    refuse_unused,
    stated_quantities,
    structure_of,
)
from reliab.app.api.assessment import assess
from reliab.app.api.channels import FileReading, find_test
from reliab.app.declaration import asks
from reliab.assessment.default_criterion import ellipses_of_motions
from reliab.assessment.judged_test import plot_errors
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.core.columns import Columns
from reliab.core.encodings import as_text
from reliab.core.errors import InputError
from reliab.core.files import ordinary, refuse_unwritable, written_whole
from reliab.core.plain_values import PlainResult, ResultWithRows
from reliab.core.progress import Progress, silent
from reliab.core.significant_digits import percent, significant
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.motions.loading import load_motions, read_motion
from reliab.recordings.record import About
from reliab.rig.memory import MEASURED_COVARIATES, NextTest
from reliab.rig.prediction import Prediction, predict_next, predict_under_motion, predict_under_suite
from reliab.rig.rig_folder import COLUMNS, RigFolder, RigTable, describe_test, require_date
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_file import read_structure
from reliab.tracking.boundary.first_order import first_order_ellipse

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from reliab.report.document import Document
    from reliab.report.setting import ReportSetting
    from reliab.structures.structure import Structure


@dataclass(frozen=True, kw_only=True)
class RigList(ResultWithRows):
    """The tests of a rig."""

    rows_in = "tests"
    keys: ClassVar[Mapping[str, str]] = {"rig": "rig", "tests": "table.whole_rows", "faults": "table.faults"}
    table_columns: ClassVar[Columns] = {
        "test": ("name", ""),
        "SHA-256": ("sha256", lambda checksum: checksum[:8], "left"),
        "date": ("date", lambda moment: moment[:10], "left"),
        "event": ("event", ""),
        "A": ("A", ".4f"),
        "d [ms]": ("d_ms", ".2f"),
        "remainder": ("remainder", significant),
        "error": ("rms", lambda error: "" if error is None else percent(error, 2)),
        "verdict": ("verdict", lambda word: word.replace("_", " "), "left"),
        "change": ("change", lambda sentence: sentence or "", "left"),
    }
    plot_columns = ("d_ms", "rms")

    rig: Path
    table: RigTable


@asks(questions.RIG)
def list_rig(rig: str | Path) -> RigList:
    """List the tests of a rig in the order of their dates.

    Raises
    ------
    InputError
        If it is no folder of a rig.
    """
    folder = RigFolder.open(rig)
    return RigList(rig=folder.path, table=folder.table())


@asks(questions.RIG, questions.KEPT_TEST)
def show_rig_test(rig: str | Path, test: str) -> dict[str, Any]:
    """Return all that is kept of a test.

    Returns
    -------
    dict
        `test` (its row), `terms` (what was stated), `assessment` (as of `reliab assess`), `record`.

    Raises
    ------
    InputError
        If there is no such test, or several.
    """
    folder = RigFolder.open(rig)
    sha256 = folder.find(test)["sha256"]
    content = folder.read(sha256)
    return {**content, "record": str(folder.record_path(sha256))}


@asks(questions.RIG, questions.KEPT_TESTS)
def remove_from_rig(rig: str | Path, tests: str | Iterable[str]) -> tuple[str, ...]:
    """Remove tests from a rig.

    Returns
    -------
    tuple of str
        Names of the tests that were removed.

    Raises
    ------
    InputError
        If one of them is no test of the rig; then none is removed.
    """
    folder = RigFolder.open(rig)
    table = folder.table()
    rows = [folder.find(test, table) for test in ([tests] if isinstance(tests, str) else tests)]
    for row in rows:
        folder.remove(row["sha256"])
    return tuple(row["name"] for row in rows)


@asks(questions.RIG, questions.RIG_TABLE)
def export_rig(rig: str | Path, out: str | Path) -> int:
    """Write the table of a rig as CSV.

    Returns
    -------
    int
        Number of tests.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    table = RigFolder.open(rig).table()
    with refuse_unwritable("Cannot write the table's file", where=out), written_whole(out) as file:
        file.write_text(table.to_csv(), encoding="utf-8", errors="backslashreplace")
    return len(table)


_ALL_TESTS = "all"
_TERMS = (
    *("f", "xi", "alpha", "scale", "feedback_lag", "mass", "skew"),
    *("equipment", "criterion", "structure", "threshold", "exact"),
)
"""What is stated of a test, in the order in which it is kept."""
_RESERVED_NAMES = ("day", "change", "file_state")


@dataclass(frozen=True, kw_only=True)
class AddedTests(PlainResult):
    """Outcome for each file that was added to a rig."""

    rig: Path
    added: tuple[dict[str, Any], ...]  # Rows of the tests that are new
    present: tuple[str, ...]  # Names of those that were there already
    faults: Mapping[str, str]  # Why files could not be judged
    tests: int  # In the rig now


@asks(questions.AddedTestQuestion, questions.RIG, questions.NEW_TESTS, as_stated=True)
def add_to_rig(
    rig: str | Path,
    tests: str | Path | Iterable[str | Path],
    *,
    progress: Progress = silent,
    **request: Unpack[questions.AddedTestQuestion],
) -> AddedTests:
    """Judge tests and keep them in the folder of their rig.

    The order of the tests, and what changed with time, follow from their dates. Tests of one earthquake are
    not independent, so state it if you know it. A test is predicted by its covariates, too. The folder is
    made if there is none; a file that is in the rig already stays as it is.

    Raises
    ------
    InputError
        If the folder cannot be written, or what is stated of all files is wrong.
    """
    files = [tests] if isinstance(tests, str | Path) else list(tests)
    if not files:
        raise InputError("No test given", remedy="Name its file")
    keeper = _Keeper(Path(rig), request)
    kept: list[tuple[str, dict[str, Any] | None]] = []
    faults: dict[str, str] = {}
    for count, file in enumerate(map(Path, files), start=1):
        try:
            for name, reading in keeper.readings_of(file).items():
                kept.append((name, keeper.keep(file, name, reading)))
        except InputError as error:
            if len(files) == 1:
                raise
            faults[str(file)] = str(error)
        progress(count, len(files))
    return AddedTests(
        rig=keeper.folder.path,
        added=tuple(row for _, row in kept if row is not None),
        present=tuple(name for name, row in kept if row is None),
        faults=faults,
        tests=len(keeper.folder.table()) if kept else 0,
    )


def parse_covariates(texts: Iterable[str], measured_columns: tuple[str, ...] = ()) -> dict[str, float]:
    """Read covariates as users write them; `measured` are columns of every test that may be among them.

    >>> parse_covariates(["current=0.4"])
    {'current': 0.4}
    """
    covariates: dict[str, float] = {}
    for text in texts:
        name, sign, number = text.partition("=")
        if (
            not sign
            or not name.isidentifier()
            or name in {*COLUMNS, *_RESERVED_NAMES} - {*measured_columns} | {*covariates}
        ):
            raise InputError(
                "A `covariate` is a new name and a number",
                value=repr(text),
                remedy="Write current=0.4",
            )
        covariates[name] = StatedValue.parse(number, f"value of {name}").value
    return covariates


class _Keeper:
    """Judges tests by the same terms and keeps them; see `add_to_rig`."""

    def __init__(self, rig: Path, question: Mapping[str, Any]) -> None:
        self.folder, self.reading = RigFolder(rig), FileReading.from_question(question)
        terms = {name: question[name] for name in _TERMS}
        self.terms = {k: value for k, value in terms.items() if value is not None and value is not False}
        labels = {name: question[name] for name in ("date", "event", "specimen", "note") if question[name]}
        if "date" in labels:
            labels["date"] = require_date(labels["date"])
        self.labels = {name: as_text(value) for name, value in labels.items()}
        self.covariates = parse_covariates(question["covariate"] or ())
        numbers = {name: f"{value:.17g}" for name, value in self.covariates.items()}
        stated = {name: as_text(str(value)) for name, value in self.terms.items()} | self.labels
        about = ("f", "xi", "alpha", "mass", "date", "specimen")
        self.about = About(
            **{name: stated[name] for name in about if name in stated},
            rig=rig.name,
            further={name: self.labels[name] for name in ("event", "note") if name in self.labels} | numbers,
        )
        self.texts = stated | numbers  # What is stated of a test, as it is kept

    def readings_of(self, file: Path) -> dict[str, FileReading]:
        """How each test of a file is read, by its name."""
        if self.reading.test_name == _ALL_TESTS:
            return self.reading.split_by_test(file)
        suffix = f", {self.reading.test_name}" if self.reading.test_name else ""
        return {f"{file.name}{suffix}": self.reading}

    def keep(self, file: Path, name: str, reading: FileReading) -> dict[str, Any] | None:
        """Judge and keep a test; None where it is there."""
        path = find_test(file)
        checksum = _checksum(path, reading.test_name)
        if self.folder.holds(checksum):
            kept_terms = cast("Mapping[str, str]", self.folder.read(checksum).get("terms", {}))
            for term, text in self.texts.items():
                if kept_terms.get(term) != text:
                    raise InputError(
                        "The rig holds this test with other statements",
                        value=f"{term} {text} now, {kept_terms.get(term) or 'nothing'} then",
                        remedy="Remove it first with `reliab rig remove` to add it anew",
                        where=str(path),
                    )
            return None
        assessment = assess(path, **{**vars(reading), **self.terms})
        now = datetime.now(tz=UTC).replace(tzinfo=None).isoformat(timespec="microseconds")
        texts = {
            "sha256": checksum,
            "name": as_text(name),
            "file": as_text(path.name),
            "added": now,
            **self.labels,
        }
        test = describe_test(assessment, texts, self.covariates)
        record, _ = reading.record(path, self.about)
        self.folder.add(test, record, assessment.to_dict(), self.texts)
        return test.to_dict()


def _checksum(path: Path, test_name: str | None) -> str:
    """SHA-256 of a test: that of its file, with its name where the file holds several."""
    try:
        with ordinary(path).open("rb") as file:
            digest = hashlib.file_digest(file, "sha256")
    except OSError as error:
        raise InputError(
            f"Cannot read the test: {error.strerror or os.fspath(path)}",
            remedy="Check its name",
            where=str(path),
        ) from None
    if test_name:
        digest.update(test_name.encode("utf-8", "surrogateescape"))
    return digest.hexdigest()


_USUAL = {"f": 1.0, "xi": 0.02}
_SHIPPED_SUITE = "real_suite"


@dataclass(frozen=True, kw_only=True, eq=False)
class RigPrediction(PlainResult):
    """The next test of a rig, predicted."""

    keys: ClassVar[Mapping[str, str]] = {
        "rig": "rig",
        **{key: f"prediction.{name}" for key, name in Prediction.keys.items()},
    }

    rig: Path
    prediction: Prediction

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the predicted error with its 90 % interval [%], and the threshold."""
        error = self.prediction.intervals["rms"]
        size = Estimate(value=error["median"], low=error["low"], high=error["high"])
        return plot_errors({"next test": size}, Metric.RMS, self.prediction.threshold, axes)


@asks(questions.PredictionQuestion, questions.RIG)
def predict_rig(rig: str | Path, **request: Unpack[questions.PredictionQuestion]) -> RigPrediction:
    """Predict the next test of a rig from all that it has done.

    Without a ground motion the error follows from those of the rig's own tests; with one the loop is
    simulated with actuators drawn from the posterior. Of a frame the rig must have tests of the same frame.

    Returns
    -------
    RigPrediction
        90 % intervals of A, d, remainder and error, the probability that the error stays below the threshold,
        and which of amplitude, delay and remainder drives it.

    Raises
    ------
    InputError
        If there are fewer than three tests, or an argument cannot be used.
    """
    table, date = RigFolder.open(rig).table(), request["date"]
    following = NextTest(
        date=require_date(date) if date else "",
        specimen=request["specimen"] or "",
        covariates=parse_covariates(request["covariate"] or (), MEASURED_COVARIATES),
    )
    limit = parse_threshold(request["threshold"])
    if request["structure"] is None:
        prediction = _predict_for_structure(table, following, limit, request)
    else:
        reason = "together with the `structure` of a frame"
        refuse_stated(request, *STRUCTURE_NAMES, "motion", "suite", reason=reason)
        frame = read_structure(request["structure"])
        prediction = predict_next(table, None, following, threshold=limit, frame=frame.name)
    return RigPrediction(rig=Path(rig), prediction=prediction)


def _predict_for_structure(
    table: RigTable, following: NextTest, limit: float, request: questions.PredictionQuestion
) -> Prediction:
    values = stated_quantities(request)
    if "f" not in values:
        raise InputError(
            "The natural frequency of the structure is missing",
            remedy="Give it in hertz, `f=1`, or a frame as `structure`",
        )
    structure, motion, suite = structure_of(values, xi=_USUAL["xi"]), request["motion"], request["suite"]
    if motion is not None:
        if suite is not None:
            raise refuse_unused("suite", "together with `motion`")
        record = read_motion(motion)
        excitation = Excitation(acceleration=record.acceleration, time_step=record.time_step)
        return predict_under_motion(table, structure, following, excitation, threshold=limit)
    if suite is None:
        return predict_next(table, structure, following, threshold=limit)
    if suite == _SHIPPED_SUITE:
        pairs = ellipses_of_motions(structure)
    else:
        ellipses = [
            first_order_ellipse(
                Excitation(acceleration=record.acceleration, time_step=record.time_step), structure
            )
            for record in load_motions(suite)
        ]
        pairs = (
            np.array([ellipse.amplitude for ellipse in ellipses]),
            np.array([ellipse.delay for ellipse in ellipses]),
        )
    return predict_under_suite(table, structure, following, pairs, threshold=limit, suite=suite)


@asks(questions.RigReportQuestion, questions.RIG, questions.RIG_PDF)
def report_rig(
    rig: str | Path,
    out: str | Path,
    *,
    setting: "ReportSetting | None" = None,
    **request: Unpack[questions.RigReportQuestion],
) -> Path:
    """Write the report of a rig: two pages for the head of the laboratory, and an appendix.

    What you leave out of the next test is taken from the last one.

    Returns
    -------
    pathlib.Path
        The PDF.

    Raises
    ------
    InputError
        If there are fewer than three tests, an argument cannot be used, or the file cannot be written.
    """
    from reliab.report.pdf import write_pdf

    document = document_of_rig(rig, **request)
    write_pdf(document, Path(out), date=datetime.now(tz=UTC).date(), setting=setting)
    return Path(out)


@asks(questions.RigReportQuestion, questions.RIG)
def document_of_rig(rig: str | Path, **request: Unpack[questions.RigReportQuestion]) -> "Document":
    """Make the document that :func:`report_rig` sets as a PDF; arguments and errors are the same."""
    from reliab.report.kinds.rig_report import rig_report

    table = RigFolder.open(rig).table()
    if not table.rows:
        raise InputError("The rig has no tests", remedy="Add some with `reliab rig add`")
    last = table.rows[-1]
    limit = parse_threshold(
        float(last["threshold"]) if request["threshold"] is None else request["threshold"]
    )
    structure: Structure | None = None
    if request["f"] is None and last["structure"]:
        prediction = predict_next(table, None, NextTest(), threshold=limit, frame=last["structure"])
    else:
        values = stated_quantities(request)
        last_values = {name: float(last[name]) for name in STRUCTURE_NAMES if last[name] is not None}
        structure = structure_of(values, **{**_USUAL, **last_values})
        prediction = predict_next(table, structure, NextTest(), threshold=limit)
    digest = hashlib.sha256("\n".join(table.texts("sha256")).encode()).hexdigest()
    return rig_report(
        Path(rig).resolve().name,
        table,
        prediction,
        structure=structure,
        provenance={"tests": len(table), "checksums of the tests, SHA-256": digest},
    )
