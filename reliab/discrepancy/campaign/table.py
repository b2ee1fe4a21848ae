"""Reading one test's CSV file, with errors that name line and column."""

from difflib import get_close_matches
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from reliab.discrepancy.campaign.campaign import Channel
from reliab.encodings import encoding_of_file
from reliab.errors import InputError
from reliab.files import ordinary, require_small
from reliab.recordings import LARGEST_READING

TIME = "time_s"
_FEWEST_SAMPLES = 64
_MOST_BYTES = 400_000_000
_RATE_TOLERANCE = 2e-3
_LARGEST_ERROR_OF_STEP = 0.75
_KNOWN = (TIME, *Channel)


def read_table(path: Path, rate: float) -> dict[Channel, NDArray[np.float64]]:
    """Read the channels of one test.

    `rate` [Hz].
    """
    columns = _read_columns(path)
    time = columns.pop(TIME)
    if time.size < _FEWEST_SAMPLES:
        raise InputError(
            f"A test must have at least {_FEWEST_SAMPLES} samples",
            value=time.size,
            remedy="Leave it out, or record longer",
            where=path.name,
        )
    _check_time(time, rate, path)
    return {Channel(name): values for name, values in columns.items()}


def _read_columns(path: Path) -> dict[str, NDArray[np.float64]]:
    header = _read_header(path)
    require_small(path, _MOST_BYTES, remedy="Resample the test, or keep its strong part")
    kept = [name for name in header if name in _KNOWN]
    if not _is_rectangular(path, len(header)):
        raise _first_fault(path, header)
    try:
        encoding = encoding_of_file(path)
        frame = pd.read_csv(path, usecols=kept, dtype=np.float64, skipinitialspace=True, encoding=encoding)
    except (ValueError, pd.errors.ParserError) as error:
        raise _first_fault(path, header) from error
    if not (np.abs(frame.to_numpy()) < LARGEST_READING).all():
        raise _first_fault(path, header)
    return {name: frame[name].to_numpy(copy=True) for name in kept}


def _is_rectangular(path: Path, columns: int) -> bool:
    """Check that every line has the right number of cells; pandas would drop surplus cells silently."""
    with path.open(encoding=encoding_of_file(path), errors="replace") as file:
        return all(line.count(",") == columns - 1 for line in file if line.strip())


def _read_header(path: Path) -> list[str]:
    try:
        with ordinary(path).open(encoding=encoding_of_file(path)) as file:
            line = file.readline()
    except (OSError, UnicodeError) as error:
        raise InputError(
            "A test's file must be a readable text file",
            value=getattr(error, "strerror", None) or "bytes that are no text",
            remedy="Check the name under [[tests]] in campaign.toml",
            where=str(path),
        ) from error
    header = [name.strip() for name in line.split(",")]
    _check_header(header, path)
    return header


def _check_header(header: list[str], path: Path) -> None:
    where = f"{path.name}, line 1"
    repeated = sorted({name for name in header if header.count(name) > 1 and name in _KNOWN})
    if repeated:
        raise InputError("A column must stand once only", value=", ".join(repeated), where=where)
    for place, name in enumerate(header, start=1):
        close = get_close_matches(name, _KNOWN, n=1, cutoff=0.7)
        if name not in _KNOWN and close and close[0] not in header:
            raise InputError(
                f"Columns must be named {', '.join(_KNOWN)}",
                value=repr(name),
                remedy=f"Name it {close[0]}, if that is what it holds, in the stated unit",
                where=f"{where}, column {place}",
            )
    if TIME not in header:
        raise InputError(
            f"The first line must be a header with the columns {TIME} and at least two channels",
            value=repr(",".join(header)[:80]),
            remedy="Separate columns by commas and name them "
            f"{', '.join(_KNOWN)}; leave out what was not measured",
            where=where,
        )


def _first_fault(path: Path, header: list[str]) -> InputError:
    """Find the first cell that is no finite number."""
    with path.open(encoding=encoding_of_file(path), errors="replace") as file:
        for number, line in enumerate(file, start=1):
            cells = line.rstrip("\r\n").split(",")
            if number == 1 or cells == [""]:
                continue
            if len(cells) != len(header):
                return InputError(
                    f"Every line must have {len(header)} columns, as the header has",
                    value=len(cells),
                    remedy="Mend the line or leave it and all later ones out",
                    where=f"{path.name}, line {number}",
                )
            for place, (name, cell) in enumerate(zip(header, cells, strict=True), start=1):
                if name in _KNOWN and not _is_number(cell):
                    return InputError(
                        f"Every value must be a finite number below {LARGEST_READING:g}",
                        value=repr(cell),
                        remedy="Repair the recording; a gap cannot be left empty",
                        where=f"{path.name}, line {number}, column {place} ({name})",
                    )
    return InputError("The file must be a table of numbers separated by commas", where=path.name)


def _is_number(cell: str) -> bool:
    try:
        return abs(float(cell)) < LARGEST_READING
    except ValueError:
        return False


def _check_time(time: NDArray[np.float64], rate: float, path: Path) -> None:
    steps = np.diff(time)
    wrong = np.flatnonzero(
        (steps <= 0.0) & (np.round(steps * rate) != 0) | (np.abs(steps * rate - 1.0) > _LARGEST_ERROR_OF_STEP)
    )
    if steps.mean() <= 0.0 or wrong.size:
        line = int(wrong[0]) + 3 if wrong.size else 3
        raise InputError(
            f"Samples must follow each other at equal steps of {1.0 / rate:.6g} s",
            value=f"{steps[line - 3]:.6g} s",
            remedy="Resample the test, or cut it where samples are missing",
            where=f"{path.name}, line {line}, column {TIME}",
        )
    measured = (time.size - 1) / (time[-1] - time[0])
    if abs(measured / rate - 1.0) > _RATE_TOLERANCE:
        raise InputError(
            "The times must agree with rate_hz of campaign.toml",
            value=f"{measured:.6g} Hz against {rate:g} Hz",
            remedy="Correct rate_hz; times are in seconds",
            where=path.name,
        )
