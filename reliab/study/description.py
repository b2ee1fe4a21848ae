"""Studies: folders with a file `study.toml`, what its tables ask for, and which of them a kind knows.

A key or a table that the kind of the study does not know, or a value that is not allowed, is refused with its
place and what is allowed; so is everything that would only be noticed after hours of simulation.

A folder may hold `kind.py`, whose `KIND` says what is done. Its modules import one another relatively, so
that a copy of the folder under another name is a study of its own; studies that ship are importable as
`reliab_studies.NAME` too. A folder is a program: `reliab run FOLDER` runs it, and nothing else
does; a run that somebody sent is never a reason to load code.
"""

import datetime as dt
import hashlib
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from importlib import import_module
from importlib.machinery import ModuleSpec
from importlib.util import module_from_spec
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from reliab.core.described_files import read_toml
from reliab.core.errors import InputError
from reliab.core.shipped import find_shipped_folder
from reliab.core.stated_value import Physical
from reliab.criterion.laws.registry import FITTED_LAWS, find_law
from reliab.criterion.methods.registry import RECOMMENDED_METHOD, method_of
from reliab.report.document import Document
from reliab.study.stages import Stage
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


@dataclass(frozen=True, kw_only=True)
class StudyKind:
    """A kind of study.

    Parameters
    ----------
    name : str
        What a study's file calls it.
    tables : type of Study
        The study with exactly the tables and keys that the kind knows.
    stages : callable
        Takes such a study; returns the stages before the report, in their order, which show their progress by
        :func:`reliab.core.progress.show_task`. What cannot be run is refused here, before the first stage.
    report : callable
        Takes such a study and its run folder; gives the report, or its content as
        :func:`reliab.report.content.read_content` reads it. Nothing is simulated any more.
    """

    name: str
    tables: type[Study]
    stages: Callable[[Any], Sequence[Stage]]
    report: Callable[[Any, Path], Document | Mapping[str, bytes]]


PACKAGE: Final = "reliab_studies"
"""Package under which the studies that ship are imported."""

FILE: Final = "study.toml"
"""What a study asks for, in its folder."""

RULE: Final = "A study is a TOML file"
REMEDY: Final = (
    "Correct the file, or name another; `reliab run --list` lists the studies that come with reliab"
)
"""What a study's file must be, and the remedy where it is not."""

_CODE: Final = "kind"


def folders_of_studies() -> dict[str, Path]:
    """Folders of the studies that ship, by their names."""
    return {file.parent.name: file.parent for file in sorted(_studies_root().glob(f"*/{FILE}"))}


def study_contents() -> dict[str, dict[str, Any]]:
    """Read the files of the studies that ship, by name; nothing of one that cannot be read."""
    contents: dict[str, dict[str, Any]] = {}
    for name, folder in folders_of_studies().items():
        contents[name] = {}
        with suppress(InputError):
            contents[name] = read_toml(folder / FILE, rule=RULE, remedy=REMEDY)
    return contents


def folders_of_kinds() -> dict[str, Path]:
    """Folders of the studies that bring their kind with them, by its name; none is imported."""
    folders = folders_of_studies()
    return {
        content["kind"]: folders[name]
        for name, content in study_contents().items()
        if isinstance(content.get("kind"), str) and (folders[name] / f"{_CODE}.py").is_file()
    }


def kind_of(folder: Path) -> StudyKind | None:
    """Import the kind of study that a folder brings with it; None where it holds no code."""
    if not (folder / f"{_CODE}.py").is_file():
        return None
    folder = folder.resolve()
    if "." in folder.name:
        raise InputError(
            "The folder of a study with code must have a name without dots",
            value=folder.name,
            remedy="Rename it",
            where=str(folder),
        )
    try:
        kind = getattr(import_module(f"{_package(folder.parent)}.{folder.name}.{_CODE}"), "KIND", None)
    except Exception as error:  # whatever the code of a study raises
        raise InputError(
            "The code of the study cannot be imported",
            value=error,
            remedy="Correct it, or install what it imports",
            where=str(folder / f"{_CODE}.py"),
        ) from error
    if not isinstance(kind, StudyKind):
        raise InputError(
            "kind.py of a study must define KIND, a reliab.study.description.Kind",
            value=f"KIND = {kind!r}",
            remedy="See studies/README.md",
            where=str(folder / f"{_CODE}.py"),
        )
    return kind


def _studies_root() -> Path:
    """Return the folder of the studies that ship; it does not exist where they were taken away."""
    return find_shipped_folder("studies").resolve()


def _package(parent: Path) -> str:
    """Make the folders below a folder importable; return the name of their package."""
    name = PACKAGE
    if parent != _studies_root():
        name = f"{PACKAGE}_{sha256(str(parent).encode()).hexdigest()[:12]}"
    if name not in sys.modules:
        spec = ModuleSpec(name, None, is_package=True)
        spec.submodule_search_locations = [str(parent)]
        sys.modules[name] = module_from_spec(spec)
    return name


_package(_studies_root())
