"""Which options of `reliab assess` have a meaning beside the others, and the files that it is given."""

from collections.abc import Sequence
from glob import glob
from pathlib import Path
from typing import Any, TypeVar

import typer

from reliab.api import unused
from reliab.cli.options import OF_REPORT, given_options
from reliab.errors import InputError

_ONLY_FOR_TESTS = (
    *("tests", "alpha", "scale", "feedback_lag", "mass", "motion", "model", "structure"),
    *("command", "measured", "time", "rate", "units", "time_units", "delimiter"),
    *("report", "date", "check", "out"),
)
_ONLY_FOR_DESIGN = ("figure",)
_IDLE_BESIDE = {
    "criterion": ("threshold", "confidence", "metric"),
    "structure": ("f", "xi", "alpha", "mass", "motion", "model", "confidence"),
}

_Value = TypeVar("_Value")


def refuse_idle(context: typer.Context, *, design: bool) -> None:
    """Refuse options that would not be used."""
    given = given_options(context)
    for name in given:
        if name in (_ONLY_FOR_TESTS if design else _ONLY_FOR_DESIGN):
            if name == "tests":
                raise InputError("A test's file has no meaning beside `design`", remedy="Leave it out")
            raise unused(name, "beside `design`" if design else "without `design`")
        if name in OF_REPORT and "report" not in given:
            raise unused(name, "without `report`")


def applicable(context: typer.Context, stated: dict[str, Any]) -> dict[str, Any]:
    """Leave out what is not stated, and a laboratory's defaults that have no meaning beside what is."""
    given = given_options(context)
    idle = {
        name
        for beside, names in _IDLE_BESIDE.items()
        if context.params.get(beside) is not None
        for name in names
        if name not in given
    }
    return {name: value for name, value in stated.items() if value is not None and name not in idle}


def only_value(values: Sequence[_Value] | None, name: str) -> _Value | None:
    """Take the value of an option that may be repeated for a design, but not for a test."""
    if not values:
        return None
    if len(values) > 1:
        raise InputError(
            f"A test has one `{name}`", value=len(values), remedy="Give several with `design` only"
        )
    return values[0]


def matched(paths: Sequence[Path]) -> list[Path]:
    """Replace patterns such as ``*.csv``, which some shells hand on as they are, by files of that name."""
    files = []
    for path in paths:
        names = [] if path.exists() else glob(str(path))  # noqa: PTH207 - absolute patterns too
        files += [Path(name) for name in sorted(names)] or [path]
    return files
