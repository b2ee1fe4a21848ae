"""Write a suite as a folder from which identical motions are read."""

import csv
import re
import unicodedata
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from reliab.core.encodings import as_cell
from reliab.core.errors import InputError
from reliab.core.files import folder_written_whole, refuse_unwritable
from reliab.motions.catalogue import CATALOGUE, COLUMNS
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.motions.units import AccelerationUnit

_UNSAFE = re.compile(r"[^A-Za-z0-9._+-]+")
_DEVICE = re.compile(r"(?:con|prn|aux|nul|com\d|lpt\d)(?:\.|$)", re.IGNORECASE)  # what Windows takes for one
_LONGEST_NAME = 100  # of a file or folder, of which most systems allow 255


def write_suite(suite: MotionSuite, folder: str | Path, *, event: str | None = None) -> Path:
    """Write every motion of a suite as text, and a catalogue.

    The samples are in m/s² with as many digits as they need to be read back unchanged, one in a line, after a
    header with units, time step, number of samples and event.

    `suite`: the motions; they are read and written one at a time; `folder`: where to write; it must not
    exist, or be empty; `event`: the earthquake of all motions, instead of their own.
    """
    target = Path(folder)
    if not len(suite):
        raise InputError("The suite has no motions to write", remedy="Choose motions that are in the suite")
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise InputError(
            "The folder is not empty",
            value=str(folder),
            remedy="Name another folder, or empty this one",
        )
    rule = "Cannot write to the folder"
    with refuse_unwritable(rule, where=target), folder_written_whole(target) as partial_folder:
        _write_all(suite, partial_folder, event)
    return target / CATALOGUE


def _write_all(suite: MotionSuite, folder: Path, event: str | None) -> None:
    with (folder / CATALOGUE).open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(COLUMNS)
        for original, file in zip(suite, _files(suite), strict=True):
            motion = original if event is None else replace(original, event=event)
            write_motion(motion, folder / file)
            labels = (as_cell(_one_line(text)) for text in (motion.name, motion.event, motion.set_name))
            rows.writerow([*labels, file, repr(motion.time_step), AccelerationUnit.METRE.value])


def write_motion(motion: Motion, path: Path) -> None:
    """Write one motion as text in one column."""
    header = (
        f"# motion: {_one_line(motion.name)}\n"
        f"# event: {_one_line(motion.event)}\n"
        f"# units: {AccelerationUnit.METRE}\n"
        f"# time_step: {motion.time_step!r}\n"
        f"# samples: {motion.acceleration.size}\n"
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    samples = "\n".join(map(repr, motion.acceleration.tolist()))
    path.write_text(f"{header}{samples}\n", encoding="utf-8", newline="\n")


def _files(suite: MotionSuite) -> Iterator[str]:
    """Name of a file for each motion, unique even where capitals do not count."""
    file_names: set[str] = set()
    for name, set_name in zip(suite.names, suite.set_names, strict=True):
        stem = _as_file(name) or "motion"
        folder = f"{_as_file(set_name) or 'motions'}/"
        file, number = f"{folder}{stem}.txt", 2
        while file.lower() in file_names:
            file, number = f"{folder}{stem}_{number}.txt", number + 1
        file_names.add(file.lower())
        yield file


def _as_file(name: str) -> str:
    file = _UNSAFE.sub("_", name)[:_LONGEST_NAME].strip(".").lstrip("+-")
    return f"_{file}" if _DEVICE.match(file) else file


def _one_line(text: str) -> str:
    """Write a label in one line of text, with what is no text as Python writes it."""
    line = " ".join(text.split())
    return "".join(
        sign.encode("unicode_escape").decode() if unicodedata.category(sign) in {"Cc", "Cs"} else sign
        for sign in line
    )
