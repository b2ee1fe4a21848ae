"""All readers, and the choice between them by content."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from reliab.core.registry import Registry
from reliab.motions.faults import Report
from reliab.motions.readers import miniseed, sac, text
from reliab.motions.readers.layouts import LAYOUTS, PLAIN, Layout
from reliab.motions.readers.source import HEAD, RecordHeader, RecordText, open_source


@dataclass(frozen=True, kw_only=True)
class RecordFormat:
    """A format of record files."""

    name: str  # Name shown to users
    # File extensions by which a file counts as this format although its content is not recognised
    endings: tuple[str, ...]
    recognises: Callable[[RecordText], bool]  # Tells from the content whether a file is one
    headers: Callable[[RecordText, Report], list[RecordHeader]]  # Reads the headers of all records of a file
    has_several_records: bool = False  # Whether one file may hold several records
    is_text: bool = True  # Whether its files are texts


def _text_format(layout: Layout) -> RecordFormat:
    return RecordFormat(
        name=layout.name,
        endings=layout.endings,
        recognises=text.recognises if layout is PLAIN else layout.recognises,
        headers=partial(text.headers, layout=layout),
        has_several_records=not layout.holds_one,
    )


TEXT = _text_format(PLAIN)
_BUILT_IN = (
    *map(_text_format, LAYOUTS),
    RecordFormat(
        name="SAC",
        endings=(".sac",),
        recognises=sac.recognises,
        headers=sac.headers,
        has_several_records=True,
        is_text=False,
    ),
    RecordFormat(
        name="miniSEED",
        endings=(".mseed", ".miniseed"),
        recognises=miniseed.recognises,
        headers=miniseed.headers,
        has_several_records=True,
        is_text=False,
    ),
    TEXT,
)

FORMATS = Registry(
    noun="format of records",
    base=RecordFormat,
    group="reliab.record_formats",
    items=_BUILT_IN,
    name_of=lambda form: form.name,
)
"""Every format by its name; other packages register a `RecordFormat`."""


UNREAD = {
    ".mat": "a MATLAB file",
    ".npy": "a NumPy file",
    ".npz": "a NumPy file",
    ".h5": "an HDF5 file",
    ".hdf5": "an HDF5 file",
    ".nc": "a netCDF file",
    ".xls": "an Excel file",
    ".xlsx": "an Excel file",
    ".evt": "a Kinemetrics EVT file",
    ".gcf": "a Guralp GCF file",
    ".sgy": "a SEG-Y file",
    ".segy": "a SEG-Y file",
    ".zip": "an archive",
    ".gz": "an archive",
    ".tar": "an archive",
}
"""Endings of files that may hold records but are not read, and what they are."""


def claims_to_be_record(path: Path) -> bool:
    """Tell whether the ending of a file's name is one of a record."""
    return any(path.suffix.lower() in form.endings for form in FORMATS.values())


def detect(source: RecordText) -> RecordFormat | None:
    """Choose the format of a file by its content, or by its extension where the content is not recognised."""
    ending = source.path.suffix.lower()
    forms = [form for form in FORMATS.values() if form.is_text is source.is_text]
    for form in forms:
        if form is not TEXT and form.recognises(source):
            return form
    for form in forms:
        if ending in form.endings:
            return form
    return TEXT if source.is_text and TEXT.recognises(source) else None


def open_records(
    path: Path, report: Report, *, whole: bool = True
) -> tuple[RecordText, list[RecordHeader]] | None:
    """Open a file and read the headers of all its records."""
    source = open_source(path, report, limit=None if whole else HEAD, binary=True)
    if source is None:
        return None
    form = detect(source)
    if form is None:
        kind = UNREAD.get(path.suffix.lower(), "binary data")
        report.add(
            "Unknown format of record" if source.is_text else "Not a record that reliab reads",
            line=1,
            value=f"none of {', '.join(FORMATS)}" if source.is_text else kind,
            remedy="Export the record as text" if source.is_text else "Unpack it or export it as text",
        )
        return None
    if form.has_several_records and not whole:
        return open_records(path, report)
    return source, form.headers(source, report)
