"""All formats of tests, and the choice between them by the first bytes of a file."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from reliab.core.errors import InputError, naming
from reliab.core.files import LIMITS, decoding, ordinary
from reliab.core.registry import Registry
from reliab.recordings.readers import hierarchical, lvm, matlab, tdms, text
from reliab.recordings.readers.columns import Columns

_HEAD: Final = 1024  # bytes


@dataclass(frozen=True, kw_only=True)
class Format:
    """A format of a test's file."""

    name: str  # Name shown to users
    recognises: Callable[[bytes], bool]  # Tells from the first 1,024 bytes whether a file is one
    # Reads the tests of a file, which may have 2 GB; the second argument separates columns, of texts only
    read: Callable[[Path, str | None], list[Columns]]


_BUILT_IN = (
    Format(
        name="HDF5, NetCDF 4 or MATLAB 7.3",
        recognises=hierarchical.recognises,
        read=hierarchical.read_hierarchical,
    ),
    Format(name="MATLAB 5 to 7.2", recognises=matlab.recognises, read=matlab.read_matlab),
    Format(name="MATLAB 4", recognises=matlab.recognises_matlab_4, read=matlab.read_matlab_4),
    Format(name="TDMS", recognises=tdms.recognises, read=tdms.read_tdms),
    Format(name="classic NetCDF", recognises=hierarchical.recognises_classic, read=hierarchical.read_classic),
    Format(name="LabVIEW measurement", recognises=lvm.recognises, read=lvm.read_lvm),
)
_BEGIN: Final = 64  # bytes in which a format that is not read says what it is
_NOT_READ: Final = {
    b"[Content_Types].xml": ("an Excel workbook", "Save its sheet as CSV"),
    b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1": ("an old Excel workbook", "Save its sheet as CSV"),
    b".npy": ("arrays of NumPy", "Save them as CSV with names of the columns"),
    b"\x93NUMPY": ("an array of NumPy", "Save it as CSV with names of the columns"),
    b"PK\x03\x04": ("an archive", "Unpack it"),
    b"PAR1": ("Parquet", "Save it as CSV, or read it with pandas and give the data frame in Python"),
    b"ARROW1": ("Feather", "Save it as CSV, or read it with pandas and give the data frame in Python"),
    b"MDF ": ("an MDF file of a measuring system", "Export it as MATLAB, HDF5 or CSV"),
    b"MATLAB 7": ("a damaged MATLAB file", "Save it again"),
}
"""Formats that are told apart but not read, by what stands at their begin: what they are, what to do."""
_TEXT: Final = Format(name="text in columns", recognises=text.recognises, read=text.read_text)

FORMATS = Registry(
    noun="format of recordings",
    base=Format,
    group="reliab.recording_formats",
    items=_BUILT_IN,
    name_of=lambda form: form.name,
)
"""Every format by its name; other packages register a `Format`. What none of them recognises may be text."""


def read_tests(path: str | Path, *, delimiter: str | None = None) -> list[Columns]:
    """Read all tests that a file holds."""
    path = Path(path)
    with decoding("Cannot read the file", remedy="Check the name, or export the test again", where=path):
        with ordinary(path).open("rb") as file:
            head = file.read(_HEAD)
        LIMITS["test"].require_small(path)
        form = next((form for form in (*FORMATS.values(), _TEXT) if form.recognises(head)), None)
        if form is not None:
            if b"\0" not in head:
                LIMITS["test"].require_narrow(path)
            with naming(path.name):
                return form.read(path, delimiter)
    kind, remedy = next(
        (description for begin, description in _NOT_READ.items() if begin in head[:_BEGIN]),
        ("this binary format", "Export the test as text in columns, MATLAB, HDF5, TDMS or NetCDF"),
    )
    raise InputError(
        f"reliab does not read {kind}",
        remedy=remedy,
        where=path.name,
    )
