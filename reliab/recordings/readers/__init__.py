"""Readers of a test's file, one format per file, chosen by what the file's first bytes say."""

from pathlib import Path

from reliab.encodings import encoding_of
from reliab.errors import InputError
from reliab.files import decoding, ordinary, require_small
from reliab.recordings.readers.columns import Columns
from reliab.recordings.readers.frame import read_frame
from reliab.recordings.readers.hierarchical import read_classic_netcdf, read_hierarchical
from reliab.recordings.readers.matlab import read_matlab
from reliab.recordings.readers.text import read_text

__all__ = ["Columns", "read_columns", "read_frame"]

_MATLAB = b"MATLAB 5.0"
_HDF5 = b"\x89HDF\r\n\x1a\n"
_CLASSIC_NETCDF = (b"CDF\x01", b"CDF\x02")
_MOST_TEXT, _MOST_BINARY = 400_000_000, 2_000_000_000
"""Largest sizes of files [bytes]; texts take about seven times their size in memory."""
_TOO_LARGE = "Leave columns out, resample the test, or cut it where everything stands still"
_MATLAB_BLOCK = 512
"""MATLAB 7.3 puts a block of its own before the HDF5 signature."""


def read_columns(path: str | Path, *, delimiter: str | None = None) -> Columns:
    """Read the columns of a test's file."""
    path = Path(path)
    with decoding(
        "A test's file must be readable", remedy="Check the name, or export the test again", where=path
    ):
        with ordinary(path).open("rb") as file:
            head = file.read(_MATLAB_BLOCK + len(_HDF5))
        require_small(path, _MOST_BINARY, remedy=_TOO_LARGE)
        if head.startswith(_HDF5) or head[_MATLAB_BLOCK:] == _HDF5:
            return read_hierarchical(path)
        if head.startswith(_MATLAB):
            return read_matlab(path)
        if head.startswith(_CLASSIC_NETCDF):
            return read_classic_netcdf(path)
        if b"\x00" not in head or encoding_of(head) == "utf-16":
            require_small(path, _MOST_TEXT, remedy=f"{_TOO_LARGE}, or export it as HDF5")
            return read_text(path, delimiter=delimiter)
    raise InputError(
        "A test's file must be text in columns, MATLAB, HDF5 or NetCDF",
        value="another binary format",
        remedy="Export it in one of these",
        where=path.name,
    )
