"""The options of one call of `reliab assess`: read, checked, and the files that they name."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from glob import glob
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from reliab.cli.options import OF_REPORT, given_options, options_of, setting_of
from reliab.errors import InputError
from reliab.files import ordinary
from reliab.shipped import or_shipped
from reliab.stated_value import StatedValue

if TYPE_CHECKING:
    from reliab.criterion import Criterion
    from reliab.report import Setting
    from reliab.validation.assessment import Recording

_ONLY_FOR_TESTS = (
    *("tests", "alpha", "scale", "feedback_lag", "mass", "motion", "model", "structure"),
    *(
        "command",
        "measured",
        "time",
        "rate",
        "units",
        "time_units",
        "delimiter",
        "report",
        "date",
        "check",
        "out",
    ),
)
_ONLY_FOR_DESIGN = ("figure",)
_QUANTITIES = ("f", "xi", "alpha", "scale", "feedback_lag", "mass")


@dataclass(frozen=True, kw_only=True)
class Demand:
    """The options of `reliab assess`, by their names; see `reliab.cli.assess.command`."""

    tests: list[Path]
    f: list[StatedValue] | None
    xi: StatedValue | None
    alpha: StatedValue | None
    scale: StatedValue | None
    feedback_lag: StatedValue | None
    mass: StatedValue | None
    motion: Path | None
    criterion: Path | None
    model: Path | None
    structure: Path | None
    threshold: float | None
    confidence: list[float] | None
    metric: str | None
    command: str | None
    measured: str | None
    time: str | None
    rate: float | None
    units: str | None
    time_units: str | None
    delimiter: str | None
    design: bool
    figure: Path | None
    report: Path | None
    title: str | None
    date: datetime | None
    paper: str
    laboratory: str | None
    logo: Path | None
    out: Path | None
    check: bool
    json_target: str | None

    @classmethod
    def read(cls, context: typer.Context) -> "Demand":
        """Take the options of a call, and refuse those that would not be used.

        Raises
        ------
        InputError
            If an option has no meaning beside the others.
        """
        given, values = given_options(context), options_of(cls, context)
        for name in _QUANTITIES:
            values[name] = _parsed(values[name], name)
        values["tests"] = [test for test in matched(values["tests"] or []) if test != values["out"]]
        demand = cls(**values)
        design = demand.design
        for name in given:
            if name in (_ONLY_FOR_TESTS if design else _ONLY_FOR_DESIGN):
                raise unused(name, "beside --design" if design else "without --design")
            if name in OF_REPORT and "report" not in given:
                raise unused(name, "without --report")
            if name in ("threshold", "confidence", "metric") and demand.criterion is not None:
                raise unused(name, "beside --criterion, which brings its own")
        if len(demand.tests) > 1 and demand.report is not None:
            raise unused("report", "beside several tests, since it is the report of one")
        if demand.f and len(demand.f) > 1 and not design:
            raise InputError("A test has one --f", value=len(demand.f), remedy="Give several with --design")
        if demand.confidence and len(demand.confidence) > 1 and not design:
            raise InputError(
                "A test has one --confidence",
                value=demand.confidence,
                remedy="Give several with --design only",
            )
        return demand

    @cached_property
    def own_criterion(self) -> "Criterion | None":
        """The user's criterion, if its file is given.

        Raises
        ------
        InputError
            If the file cannot be read.
        """
        if self.criterion is None:
            return None
        from reliab.criterion import Criterion

        try:
            text = ordinary(self.criterion).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(
                "The criterion's file must be readable",
                value=getattr(error, "strerror", None) or "no text",
                remedy="Write one with `reliab criterion --out`",
                where=str(self.criterion),
            ) from error
        return Criterion.from_json(text)

    @property
    def setting(self) -> "Setting":
        """How the report is set.

        Raises
        ------
        InputError
            If the paper is not known or the logo cannot be read.
        """
        return setting_of(self.title, self.date, self.paper, self.laboratory, self.logo)

    def read_recording(self, test: Path) -> "Recording":
        """Read a test.

        Parameters
        ----------
        test : pathlib.Path
            Its file, or the name of a test that ships.

        Raises
        ------
        InputError
            If its file cannot be read.
        """
        from reliab.validation.assessment import read_recording

        return read_recording(
            or_shipped(test, "datasets", "test.csv"),
            command=self.command,
            measured=self.measured,
            time=self.time,
            rate_hz=self.rate,
            units=self.units,
            time_units=self.time_units,
            delimiter=self.delimiter,
        )


def matched(paths: Sequence[Path]) -> list[Path]:
    """Replace patterns such as ``*.csv``, which some shells hand on as they are, by the files of that name.

    Parameters
    ----------
    paths : sequence of pathlib.Path
        Files and patterns.

    Returns
    -------
    list of pathlib.Path
        Files; a pattern that matches none stays, to be named in the error.
    """
    files = []
    for path in paths:
        names = [] if path.exists() else glob(str(path))  # noqa: PTH207 - absolute patterns too
        files += [Path(name) for name in sorted(names)] or [path]
    return files


def _parsed(text: Any, name: str) -> Any:  # noqa: ANN401 - one text or several
    """Read what an option states; several where it may be repeated."""
    if text is None:
        return None
    if isinstance(text, str):
        return StatedValue.parse(text, f"value of --{name.replace('_', '-')}")
    return [_parsed(item, name) for item in text]


def unused(name: str, why: str) -> InputError:
    """Describe an option that would have no effect.

    Parameters
    ----------
    name : str
        Its name in Python.
    why : str
        Beside or without which other option it has no meaning.

    Returns
    -------
    InputError
        To be raised.
    """
    spoken = "A test's file" if name == "tests" else f"--{name.replace('_', '-')}"
    return InputError(f"{spoken} has no meaning {why}", remedy="Leave it out")
