"""Faults found in record files, collected so that one check reports them all."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from reliab.core.errors import InputError
from reliab.core.untrusted_files import resolve_within

T = TypeVar("T")


@dataclass(frozen=True, kw_only=True)
class MotionFault:
    """One thing that is wrong with one file."""

    file: str  # The file, as the user named it
    line: int | None  # Line in the file, counted from 1; None where the fault has no line
    rule: str  # What must hold
    value: str = ""  # What was found instead; may be empty
    remedy: str = ""  # What to do about it; may be empty

    def error(self) -> InputError:
        """Return the fault as an error of one sentence for the user."""
        location = self.file if self.line is None else f"{self.file}, line {self.line}"
        return InputError(self.rule, value=self.value or None, remedy=self.remedy, where=location)


def fault_of(error: InputError, name: str) -> MotionFault:
    """Make an error about a record a fault of its file, or of its name where the error tells no file.

    >>> fault_of(InputError("It must be so", where="a.AT2, line 3"), "a").line
    3
    """
    file, _, line = error.where.rpartition(", line ")
    has_line = line.isdecimal()
    return MotionFault(
        file=(file if has_line else error.where) or name,
        line=int(line) if has_line else None,
        rule=error.rule,
        value="" if error.value is None else str(error.value),
        remedy=error.remedy,
    )


@dataclass(frozen=True, kw_only=True)
class Report:
    """The faults of one file, in the order in which they were found."""

    file: str  # The file, as the user named it
    faults: list[MotionFault] = field(default_factory=list)

    def add(self, rule: str, *, line: int | None = None, value: object = "", remedy: str = "") -> None:
        """Record a fault of the file."""
        self.faults.append(MotionFault(file=self.file, line=line, rule=rule, value=str(value), remedy=remedy))

    def resolve(self, folder: Path, name: str, *, line: int | None = None) -> Path | None:
        """Return the path of a file that a folder names, or record that it lies elsewhere."""
        try:
            return resolve_within(folder, name, where=self.file)
        except InputError as error:
            self.add(error.rule, line=line, value=error.value, remedy=error.remedy)
            return None

    def require(self, value: T | None) -> T:
        """Return what was found if the file has no fault."""
        if value is None or self.faults:
            raise self.faults[0].error()
        return value
