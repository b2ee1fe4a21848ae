"""What a study asks for: the tables and keys of its TOML file.

A key that is not known, or a value that is not allowed, is refused with its place and what is allowed.
"""

import datetime as dt
import hashlib
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from reliab.errors import InputError

Share = Annotated[float, Field(gt=0.0, lt=1.0)]
Positive = Annotated[float, Field(gt=0.0)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class MotionsTable(_Table):
    """`[motions]`: which ground motions; or which results of theirs, a store or "real_suite"."""

    sources: tuple[str, ...] | None = None
    sets: tuple[str, ...] | None = None
    results: str | None = None

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if self.sources is not None and self.results is not None:
            message = "sources and results exclude each other"
            raise ValueError(message)
        return self


class StructuresTable(_Table):
    """`[structures]`: which structures."""

    f: tuple[Positive, ...] = (1.0,)
    xi: tuple[Share, ...] = (0.02,)
    experimental_fraction: Annotated[float, Field(gt=0.0, le=1.0)] = 1.0


class ErrorsTable(_Table):
    """`[errors]`: which errors of the whole test, and where they are taken."""

    thresholds: tuple[Positive, ...] = (0.05,)
    metrics: tuple[Literal["rms", "mte"], ...] = ("rms",)
    window: str = "record"


class CriterionTable(_Table):
    """`[criterion]`: what the criterion promises."""

    confidences: tuple[Share, ...] = (0.95,)
    method: str = "dirichlet"
    joint: bool = True
    law: str = "table"


class ValidationTable(_Table):
    """`[validation]`: how the criterion is put to the test."""

    schemes: tuple[Literal["leave_one_event_out", "k_fold", "random_halves"], ...] = ("leave_one_event_out",)
    confidences: tuple[Share, ...] = (0.50, 0.60, 0.70, 0.80, 0.90, 0.95, 0.99)
    trials: Annotated[int, Field(ge=64, le=65536)] = 512
    held_out: str | None = None


class CampaignTable(_Table):
    """`[campaign]`: a measured campaign."""

    folder: str


class Study(_Table):
    """A study.

    Attributes
    ----------
    title : str
        Title of the report.
    kind : str
        What is done: see the modules of `reliab.study.kinds`.
    purpose : str
        A sentence or two on what it is for.
    date : str
        Date of the report, fixed so that its bytes are.
    """

    title: str
    kind: Literal["criterion", "paper", "validation", "suites", "audit", "discrepancy", "blind_evaluation"]
    purpose: str = ""
    date: dt.date = dt.date(2026, 1, 1)
    motions: MotionsTable = MotionsTable()
    structures: StructuresTable = StructuresTable()
    errors: ErrorsTable = ErrorsTable()
    criterion: CriterionTable = CriterionTable()
    validation: ValidationTable = ValidationTable()
    campaign: CampaignTable | None = None

    def on(self, sources: Sequence[str] | None, sets: Sequence[str] | None) -> Self:
        """Return the same study on other ground motions.

        Parameters
        ----------
        sources, sets : sequence of str or None
            As the keys of `[motions]`; None keeps what the study says.

        Returns
        -------
        Study
            The study.
        """
        known = self.motions
        chosen = MotionsTable(
            sources=known.sources if sources is None else tuple(sources),
            sets=known.sets if sets is None else tuple(sets),
            results=known.results if sources is None else None,
        )
        return self.model_copy(update={"motions": chosen})

    def digest(self) -> str:
        """Return the SHA-256 of everything that the study asks for."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()

    @property
    def provenance(self) -> dict[str, str]:
        """What the study's report is known by."""
        return {"study": self.title, "study, SHA-256": self.digest()}


def read_study(path: str | Path) -> Study:
    """Read a study.

    Parameters
    ----------
    path : str or pathlib.Path
        Its TOML file.

    Returns
    -------
    Study
        The study.

    Raises
    ------
    InputError
        If the file is missing, no TOML, or a key or value is not allowed; all faults at once.
    """
    path = Path(path)
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(
            "A study is a TOML file",
            value=error.strerror,
            remedy="Name one that exists; `reliab run --list` lists those that are shipped",
            where=str(path),
        ) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(
            "A study must be valid TOML", value=error, remedy="Mend the file", where=str(path)
        ) from None
    try:
        return Study.model_validate(content)
    except ValidationError as error:
        raise InputError(
            "A study holds known keys with allowed values",
            value="; ".join(_fault(each) for each in error.errors()),
            remedy="Compare with the studies that are shipped",
            where=str(path),
        ) from None


def _fault(error: object) -> str:
    """One fault with the place of its key."""
    details = dict(error)  # type: ignore[call-overload]
    place = ".".join(str(part) for part in details["loc"]) or "the file"
    if details["type"] == "extra_forbidden":
        return f"{place} is not a known key"
    return f"{place}: {details['msg'][0].lower()}{details['msg'][1:]}, not {details['input']!r}"
