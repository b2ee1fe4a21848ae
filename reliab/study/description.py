"""What a study asks for: the tables of its TOML file, and which of them its kind knows.

A key or a table that the kind of the study does not know, or a value that is not allowed, is refused with its
place and what is allowed; so is everything that would only be noticed after hours of simulation.
"""

import datetime as dt
import hashlib
from collections.abc import Sequence
from typing import Annotated, Literal, Self, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from reliab.core.errors import InputError
from reliab.core.physical_range import Physical
from reliab.criterion.laws.registry import FITTED_LAWS, find_law
from reliab.criterion.methods.registry import RECOMMENDED_METHOD, method_of
from reliab.tracking.indices.window import Window

_Value = TypeVar("_Value")


def _distinct(values: tuple[_Value, ...]) -> tuple[_Value, ...]:
    if not values:
        message = "at least one value is needed"
        raise ValueError(message)
    if len(set(values)) < len(values):
        message = "each value is given once"
        raise ValueError(message)
    return values


def _window(text: str) -> str:
    return Window.parse(text).label


def _method(name: str) -> str:
    method_of(name)
    return name


def _law(name: str) -> str:
    find_law(FITTED_LAWS, name)
    return name


Share = Annotated[float, Field(gt=0.0, lt=1.0)]
Shares = Annotated[tuple[Share, ...], AfterValidator(_distinct)]
Frequencies = Annotated[
    tuple[Annotated[float, Physical("natural frequency")], ...], AfterValidator(_distinct)
]
DampingRatios = Annotated[tuple[Annotated[float, Physical("damping ratio")], ...], AfterValidator(_distinct)]
Thresholds = Annotated[tuple[Annotated[float, Physical("error threshold")], ...], AfterValidator(_distinct)]
Names = Annotated[tuple[str, ...], AfterValidator(_distinct)]


class StudyTable(BaseModel):
    """A table of a study: its keys and no others."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class RecordsTable(StudyTable):
    """`[motions]`: which records."""

    sources: Names | None = None
    sets: Names | None = None


class MotionsTable(RecordsTable):
    """`[motions]`: which records; or which results of theirs, a store or "real_suite"."""

    results: str | None = None

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if self.results is not None and (self.sources is not None or self.sets is not None):
            message = "results cannot be combined with sources or sets"
            raise ValueError(message)
        return self


class StructuresTable(StudyTable):
    """`[structures]`: which structures."""

    f: Frequencies = (1.0,)
    xi: DampingRatios = (0.02,)
    experimental_fraction: Annotated[float, Physical("share of the stiffness in the laboratory")] = 1.0


class ErrorsTable(StudyTable):
    """`[errors]`: which errors of the whole test, and over which part of the record they are computed."""

    thresholds: Thresholds = (0.05,)
    metrics: Annotated[tuple[Literal["rms", "mte"], ...], AfterValidator(_distinct)] = ("rms",)
    window: Annotated[str, AfterValidator(_window)] = "record"


class CriterionTable(StudyTable):
    """`[criterion]`: what the criterion promises."""

    confidences: Shares = (0.95,)
    method: Annotated[str, AfterValidator(_method)] = RECOMMENDED_METHOD
    joint: bool | None = None
    law: Annotated[str, AfterValidator(_law)] = "table"


class TransferValidationTable(StudyTable):
    """`[validation]`: how a criterion is judged on the motions of another suite."""

    confidences: Shares = (0.50, 0.60, 0.70, 0.80, 0.90, 0.95, 0.99)
    trials: Annotated[int, Field(ge=64, le=65536)] = 512


class ValidationTable(TransferValidationTable):
    """`[validation]`: how the criterion is put to the test."""

    schemes: Annotated[
        tuple[Literal["leave_one_event_out", "k_fold", "random_halves"], ...], AfterValidator(_distinct)
    ] = ("leave_one_event_out",)


class Study(StudyTable):
    """A study; each kind adds the tables that it knows."""

    title: str  # Title of the report
    kind: str  # What is done: see the modules of `reliab.study.kinds`
    purpose: str = ""  # A sentence or two on what it is for
    # Date of the report, given where its bytes are to be reproducible; the day on which the report is written
    # by default
    date: dt.date | None = None

    def full_title(self, population: str) -> str:
        """Title of the report with the ground motions that it is about, in words."""
        if self.title.endswith("?"):
            return f"{self.title} {population[:1].upper()}{population[1:]}"
        return f"{self.title}: {population}"

    def replace_motions(self, sources: Sequence[str] | None, sets: Sequence[str] | None) -> Self:
        """Return the same study on other ground motions.

        `sources`, `sets`: as the keys of `[motions]`; None keeps what the study says.
        """
        raise InputError(
            f"Studies of the kind {self.kind} take no ground motions",
            value=f"motions {', '.join(sources or sets or ())}",
            remedy="Leave it out",
        )

    def digest(self) -> str:
        """Return the SHA-256 of everything that the study asks for."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()

    @property
    def provenance(self) -> dict[str, object]:
        """Title and digest by which the report names the study."""
        return {"study": self.title, "study, SHA-256": self.digest()}


class RecordsStudy(Study):
    """A study of records."""

    motions: RecordsTable = RecordsTable()

    def replace_motions(self, sources: Sequence[str] | None, sets: Sequence[str] | None) -> Self:
        """Return the same study on other records."""
        present = self.motions.model_dump()
        if sources is not None and "results" in present:
            present["results"] = None
        changes = {"sources": sources and tuple(sources), "sets": sets and tuple(sets)}
        tables = {**present, **{name: value for name, value in changes.items() if value is not None}}
        try:
            motions = type(self.motions).model_validate(tables)
        except ValueError as error:
            raise InputError(
                "Only a catalogue of records has sets",
                value="`sets` for a study of stored results",
                remedy="Give the records with `motions`, or leave `sets` out",
            ) from error
        return self.model_copy(update={"motions": motions})


class SimulatedStudy(RecordsStudy):
    """A study that simulates records, or takes results that are stored."""

    structures: StructuresTable = StructuresTable()
    errors: ErrorsTable = ErrorsTable()


class CriterionStudy(SimulatedStudy):
    """A study that derives criteria and puts them to the test."""

    motions: MotionsTable = MotionsTable()
    criterion: CriterionTable = CriterionTable()
    validation: ValidationTable = ValidationTable()
