"""Errors that a user can act on: each states the rule, the value found and the remedy."""

import contextlib
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

INTERRUPTED: Final = 130
"""Exit code after Ctrl-C, as shells give it."""

CLOSED_PIPE: Final = 141
"""Exit code where nobody reads the output to its end, as shells give it."""

UNEXPECTED: Final = 70
"""Exit code after a fault of the program itself, as `sysexits.h` has it; 1 is the answer no alone."""

_LONGEST_VALUE = 1000


class ReliabError(Exception):
    """Base of every error that this package raises on purpose."""


class InputError(ReliabError, ValueError):
    """Something that the user gave breaks a rule.

    Parameters
    ----------
    rule : str
        What must hold, as a statement ("The time step must be positive").
    value : object, optional
        What was found instead.
    remedy : str, optional
        What to do about it, as a sentence without its final full stop.
    where : str, optional
        Where the value stands: a file and line, an option, a key.

    Examples
    --------
    >>> raise InputError("The damping ratio must lie in (0, 1)", value=2.0, remedy="Give 0.02 for 2 %")
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: The damping ratio must lie in (0, 1); found 2.0. Give 0.02 for 2 %.
    """

    def __init__(self, rule: str, *, value: object = None, remedy: str = "", where: str = "") -> None:
        self.rule = rule = _shorten(rule)  # it may name a key of the user's file
        self.value = value
        self.remedy = remedy
        self.where = where = _shorten(where)
        place = f"{where}: " if where else ""
        clause = "" if value is None else f"; found {_shorten(str(value))}"
        advice = f" {remedy}." if remedy else ""
        super().__init__(f"{place}{rule}{clause}.{advice}")

    def at(self, where: str) -> "InputError":
        """Return the same error with the place at which the value stands."""
        return InputError(self.rule, value=self.value, remedy=self.remedy, where=where)


@contextlib.contextmanager
def naming(where: str) -> "Iterator[None]":
    """Name a file, or a place in it, in errors that do not say where they stand.

    >>> with naming("test.csv"):
    ...     raise InputError("The unit must be one of length", value="kN")
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: test.csv: The unit must be one of length; found kN.
    """
    try:
        yield
    except InputError as error:
        if error.where:
            raise
        raise InputError(error.rule, value=error.value, remedy=error.remedy, where=where) from error


def _shorten(value: str) -> str:
    return value if len(value) <= _LONGEST_VALUE else f"{value[:_LONGEST_VALUE]} …"


class IncompleteError(ReliabError):
    """Work stopped half-way; what is finished is safe and can be resumed."""
