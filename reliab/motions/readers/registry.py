"""All readers, and the choice between them by content."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from reliab.motions.faults import Report
from reliab.motions.readers import cosmos, csmip, knet, peer, text
from reliab.motions.readers.header import Header
from reliab.motions.readers.source import HEAD, Source, open_source
from reliab.registry import Registry


@dataclass(frozen=True, kw_only=True)
class Format:
    """A format of record files."""

    name: str  # Name shown to users
    # File extensions by which a file counts as this format although its content is not recognised
    endings: tuple[str, ...]
    recognises: Callable[[Source], bool]  # Tells from the content whether a file is one
    headers: Callable[[Source, Report], list[Header]]  # Reads the headers of all records of a file
    several: bool = False  # Whether one file may hold several records


TEXT = Format(
    name="text",
    endings=(".txt", ".csv", ".tsv", ".dat", ".asc", ".acc"),
    recognises=text.recognises,
    headers=text.headers,
)
_SHIPPED = (
    Format(name="PEER AT2", endings=(".at2",), recognises=peer.recognises, headers=peer.headers),
    Format(
        name="K-NET",
        endings=(".ns", ".ew", ".ud", ".ns1", ".ew1", ".ud1", ".ns2", ".ew2", ".ud2"),
        recognises=knet.recognises,
        headers=knet.headers,
    ),
    Format(
        name="COSMOS",
        endings=(".v2c", ".v1c"),
        recognises=cosmos.recognises,
        headers=cosmos.headers,
        several=True,
    ),
    Format(
        name="CSMIP Volume 2",
        endings=(".v2",),
        recognises=csmip.recognises,
        headers=csmip.headers,
        several=True,
    ),
    TEXT,
)

FORMATS = Registry(
    noun="format of records",
    base=Format,
    group="reliab.record_formats",
    shipped=_SHIPPED,
    name_of=lambda form: form.name,
)
"""Every format by its name; other packages register a `Format`."""


def claims_to_be_record(path: Path) -> bool:
    """Tell whether the ending of a file's name is one of a record."""
    return any(path.suffix.lower() in form.endings for form in FORMATS.values())


def detect(source: Source) -> Format | None:
    """Choose the format of a file by its content, or by its extension where the content is not recognised."""
    ending = source.path.suffix.lower()
    for form in FORMATS.values():
        if form is not TEXT and form.recognises(source):
            return form
    for form in FORMATS.values():
        if ending in form.endings:
            return form
    return TEXT if TEXT.recognises(source) else None


def open_records(path: Path, report: Report, *, whole: bool = True) -> tuple[Source, list[Header]] | None:
    """Open a file and read the headers of all its records."""
    source = open_source(path, report, limit=None if whole else HEAD)
    if source is None:
        return None
    form = detect(source)
    if form is None:
        report.add(
            "The format must be known",
            line=1,
            value=f"none of {', '.join(FORMATS)}",
            remedy="Export the record as text",
        )
        return None
    if form.several and not whole:
        return open_records(path, report)
    return source, form.headers(source, report)
