"""A folder of records without a catalogue.

Every record below the folder is a motion. Its name is its path relative to the folder. The file extension is
left out if it is one of a record format and the name stays unique; channels of one file are numbered.

Events are known only where the headers say so: records share an event if they are channels of one file, or
if their headers give the same earthquake and date (PEER), the same origin time and epicentre (K-NET), the
same origin time (CSMIP, COSMOS) or the same line ``# event: NAME`` (text). Every other motion counts as a
separate event. To declare events, write a catalogue with a column ``event``.
"""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from reliab.motions.catalogue import CATALOGUE
from reliab.motions.faults import Report
from reliab.motions.readers.reading import Declared
from reliab.motions.readers.registry import TEXT, claims_to_be_record, detect, open_records
from reliab.motions.readers.source import HEAD, open_source
from reliab.motions.record import RecordFile

_STRIPPED = frozenset((".at2", ".v2", ".v2c", ".txt", ".csv", ".tsv", ".dat", ".asc", ".acc"))
UNREAD = {
    ".mat": "a MATLAB file",
    ".npy": "a NumPy file",
    ".npz": "a NumPy file",
    ".h5": "an HDF5 file",
    ".hdf5": "an HDF5 file",
    ".nc": "a netCDF file",
    ".xls": "an Excel file",
    ".xlsx": "an Excel file",
    ".sac": "a SAC file",
    ".mseed": "a miniSEED file",
    ".smc": "an SMC file",
    ".zip": "an archive",
    ".gz": "an archive",
}
"""Endings of files that may hold records but are not read, and what they are."""

_NOT_RECORDS = ("readme", "license", "licence", "copying", "changelog")


def scan_folder(folder: Path, given: Declared) -> Iterator[tuple[Path, list[RecordFile], Report]]:
    """Find the records of a folder."""
    paths = [path for path in sorted(folder.rglob("*")) if _may_be_record(path, folder)]
    names = _names(paths, folder)
    for path in paths:
        report = Report(file=str(path))
        inside = report.within(folder, path.relative_to(folder).as_posix())
        yield path, scan_file(path, names[path], given, report) if inside else [], report


class UnreadFileWarning(UserWarning):
    """A folder holds files that may be records in a format that is not read."""


def unread_files(folder: Path) -> list[Path]:
    """Find files of a folder that may hold records in a format that is not read."""
    paths = sorted(path for path in folder.rglob("*") if path.suffix.lower() in UNREAD and path.is_file())
    hidden = (any(part.startswith(".") for part in path.relative_to(folder).parts) for path in paths)
    return [path for path, out_of_sight in zip(paths, hidden, strict=True) if not out_of_sight]


def scan_file(path: Path, name: str, given: Declared, report: Report) -> list[RecordFile]:
    """Find the motions in one file."""
    opened = open_records(path, report, whole=False)
    headers = opened[1] if opened else []
    if len(headers) == 1:
        return [RecordFile(path=path, name=name, event=headers[0].event or name, declared=given)]
    return [
        RecordFile(
            path=path, name=f"{name}/{channel}", event=header.event or name, channel=channel, declared=given
        )
        for channel, header in enumerate(headers, start=1)
    ]


def _may_be_record(path: Path, folder: Path) -> bool:
    """Tell whether a file has the extension of a record or is recognised by its header."""
    inner = path.relative_to(folder)
    if any(part.startswith(".") for part in inner.parts) or not path.is_file():
        return False
    if path.name.lower() == CATALOGUE or path.stem.lower().lstrip("_").startswith(_NOT_RECORDS):
        return False
    if claims_to_be_record(path):
        return True
    source = open_source(path, Report(file=str(path)), limit=HEAD)
    return source is not None and detect(source) not in {None, TEXT}


def _names(paths: list[Path], folder: Path) -> dict[Path, str]:
    short = {path: motion_name(path.relative_to(folder)) for path in paths}
    count = Counter(short.values())
    return {
        path: name if count[name] == 1 else path.relative_to(folder).as_posix()
        for path, name in short.items()
    }


def motion_name(path: Path) -> str:
    """Name of a motion after its file: the path without the ending of a record.

    Extensions that name a component, such as ``.NS`` and ``.EW`` of K-NET, are kept.

    >>> motion_name(Path("KOBE/NIS000.AT2")), motion_name(Path("AOM001.EW"))
    ('KOBE/NIS000', 'AOM001.EW')
    """
    name = (path.with_suffix("") if path.suffix.lower() in _STRIPPED else path).as_posix()
    return name.encode(errors="backslashreplace").decode()  # bytes of a name that are not text
