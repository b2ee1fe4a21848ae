"""`reliab record` and `calibrate`: a laboratory's file as an open record, and what its channels add."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypedDict

import typer

from reliab.app import questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import console, say, show_rows, show_table, write_json
from reliab.app.declaration import argument, group
from reliab.app.options import OUTPUT, TEST
from reliab.core.columns import Columns
from reliab.core.errors import InputError
from reliab.core.significant_digits import decimals_of_uncertainty, significant
from reliab.core.stated_value import Names
from reliab.core.vocabulary import MILLI

if TYPE_CHECKING:
    from reliab.app.api.records import Record
    from reliab.core.stated_value import StatedValue
    from reliab.recordings.calibration import ChannelCalibration


_COLUMNS: Columns = {
    "channel": ("channel", ""),
    "column": ("column", ""),
    "unit": ("unit", ""),
    "factor to SI": ("factor", ".6g"),
    "reason": ("reason", ""),
}


@group
class _Files(TypedDict, total=False):
    """Tests to judge, or what is written.

    sources: Files of a laboratory; with --check records.
    out: The record; for several files a folder of records.
    attribute: Further attributes of the record.
    check: Check records; exit with code 1 unless all are valid.
    """

    sources: Annotated[list[Path], argument("FILE...")]
    out: Annotated[Path | None, OUTPUT.option("TEST.nc")]
    attribute: Annotated[Names | None, TEST.advanced("NAME=TEXT...")]
    check: Annotated[bool, OUTPUT.flag()]


@takes(questions.RecordQuestion, _Files)
def record(request: Request) -> None:
    """Recognise the channels of your file and save them as one open record."""
    if request.check:
        _check(request)
        return
    if request.csv is not None and len(request.sources) > 1:
        raise InputError(
            "A CSV file holds one test only", value=f"{len(request.sources)} files", remedy="Name one file"
        )
    stems = [source.stem for source in request.sources]
    twice = next((stem for stem in stems if stems.count(stem) > 1), None)
    if request.out is not None and twice is not None:
        raise InputError(
            "Several files have the same name",
            value=twice,
            remedy="Rename them, or name another `out` for each",
        )
    records = [_record(source, request) for source in request.sources]
    contents = [record.to_dict() for record in records]
    if not write_json(contents[0] if len(contents) == 1 else contents, request.json_target):
        for answer in records:
            _show(answer)


def _record(source: Path, request: Request) -> "Record":
    from reliab.app.api.records import record as api_record

    out = request.out
    if out is not None and len(request.sources) > 1:
        out.mkdir(parents=True, exist_ok=True)
        out = out / f"{source.stem}.nc"
    return request.ask(
        api_record,
        *("sources", "attribute"),
        source=source,
        out=out,
        attributes=dict(map(_attribute, request.attribute or [])),
    )


def _attribute(text: str) -> tuple[str, str]:
    name, sign, value = text.partition("=")
    if not sign or not name.isidentifier():
        raise InputError(
            "An attribute is written as NAME=TEXT", value=text, remedy="Write specimen_grade=S355"
        )
    return name, value


def _check(request: Request) -> None:
    from reliab.app.api.records import check_records

    request.refuse_all_but(("sources", "check", "json_target"), "together with `check`")
    faults = check_records(request.sources)
    if not write_json(faults, request.json_target):
        for file, sentences in faults.items():
            console().print(
                f"{file}: {'a valid record' if not sentences else 'not a valid record'}", markup=False
            )
            say(*(f"  {sentence}" for sentence in sentences))
    if any(faults.values()):
        raise typer.Exit(1)


def _show(record: "Record") -> None:
    """Print what was recognised, and where it was written."""
    content = record.to_dict()
    title = f"{content['source']}: {content['samples']:,} samples at {content['rate_hz']:.6g} Hz"
    show_rows(title, _COLUMNS, content["recording"]["channels"])
    if content["left"]:
        say(f"Not used: {', '.join(content['left'])}.")
    say(*(f"Note: {note}" for note in content["notes"]))
    say(*(f"Written: {path}" for path in content["files"]))


_UNDETERMINED = 10.0  # times the value: a deviation from which nothing is known of it


@takes(questions.CalibrationQuestion, questions.CALIBRATION_TEST)
def calibrate(request: Request) -> None:
    """Measure skew, scale, hysteresis, noise and resolution of the two displacement channels."""
    from reliab.app.api.records import calibrate as api_calibrate

    request.answer(api_calibrate, _show_calibration)


def _show_calibration(calibration: "ChannelCalibration") -> None:
    quantities = {
        "delay behind the command's channel [ms]": calibration.skew_ms,
        "scale relative to the command's channel [-]": calibration.scale,
        "hysteresis over the range of the motion [-]": calibration.hysteresis,
    }
    lengths = {
        "noise of the measured channel, RMS [mm]": calibration.noise_m,
        "noise of the command's channel, RMS [mm]": calibration.command_noise_m,
        "step between readings [mm]": calibration.resolution_m,
    }
    show_table(
        "What the measured channel adds to the motion",
        {"": "left", "value": "right", "± 1 sd": "right"},
        [(name, *_cells(quantity)) for name, quantity in quantities.items()]
        + [
            (name, significant(MILLI * length, 2) if length else "none", "")
            for name, length in lengths.items()
        ],
    )
    say(*(f"Note: {note}" for note in calibration.notes))


def _cells(quantity: "StatedValue | None") -> tuple[str, str]:
    if quantity is None or quantity.deviation > _UNDETERMINED * abs(quantity.value):
        return "not determined", ""
    decimals = decimals_of_uncertainty(quantity.deviation)
    return f"{quantity.value:.{decimals}f}", f"{quantity.deviation:.{decimals}f}"
