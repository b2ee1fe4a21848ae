"""Folders of studies: a file `study.toml`, and beside it the code and pages that only this study needs.

A folder may hold `kind.py`, whose `KIND` says what is done. Its modules import one another relatively, so
that a copy of the folder under another name is a study of its own; studies that ship are importable as
`reliab_studies.NAME` too. A folder is a program: `reliab run FOLDER` runs it, and nothing else
does; a run that somebody sent is never a reason to load code.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from importlib import import_module
from importlib.machinery import ModuleSpec
from importlib.util import module_from_spec
from pathlib import Path
from typing import Any, Final

from reliab.core.described_files import read_toml
from reliab.core.errors import InputError
from reliab.core.shipped import find_shipped_folder
from reliab.report.document import Document
from reliab.study.description import Study
from reliab.study.stages import Stage


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
            "kind.py of a study must define KIND, a reliab.study.folders.Kind",
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
