"""Folders of studies: a file `study.toml`, and beside it the code and pages that only this study needs.

A folder may hold `kind.py`, whose `KIND` says what is done. Its modules import one another relatively, so
that a copy of the folder under another name is a study of its own; studies that ship are importable as
`reliab_studies.NAME` too. A folder is a program: `reliab run FOLDER` runs it, and nothing else
does; a run that somebody sent is never a reason to load code.
"""

import sys
from hashlib import sha256
from importlib import import_module
from importlib.machinery import ModuleSpec
from importlib.util import module_from_spec
from pathlib import Path
from types import ModuleType
from typing import Final

from reliab.core.errors import InputError
from reliab.core.shipped import shipped_folder
from reliab.study.kind import Kind

PACKAGE: Final = "reliab_studies"
"""Package under which the studies that ship are imported."""

FILE: Final = "study.toml"
"""What a study asks for, in its folder."""

_CODE: Final = "kind"


def shipped_folders() -> dict[str, Path]:
    """Folders of the studies that ship, by their names."""
    return {file.parent.name: file.parent for file in sorted(_shipped().glob(f"*/{FILE}"))}


def shipped_kinds() -> list[Kind]:
    """Kinds that the studies that ship bring with them."""
    return [kind for folder in shipped_folders().values() if (kind := kind_of(folder)) is not None]


def kind_of(folder: Path) -> Kind | None:
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
        kind = getattr(_module(folder, _CODE), "KIND", None)
    except (ImportError, SyntaxError) as error:
        raise InputError(
            "The code of a study must be importable",
            value=error,
            remedy="Correct it, or install what it imports",
            where=str(folder / f"{_CODE}.py"),
        ) from error
    if not isinstance(kind, Kind):
        raise InputError(
            "kind.py of a study must define KIND, a reliab.study.kind.Kind",
            value=f"KIND = {kind!r}",
            remedy="See studies/README.md",
            where=str(folder / f"{_CODE}.py"),
        )
    return kind


def study_module(study: str, module: str) -> ModuleType:
    """Import a module of a study that ships; refuse where the studies are not installed."""
    folder = shipped_folders().get(study)
    if folder is None:
        raise InputError(
            f"This needs the study {study}, which ships with the package",
            value="no such study here",
            remedy="Install reliab with its studies",
        )
    return _module(folder, module)


def _module(folder: Path, module: str) -> ModuleType:
    """Import a module of the folder of a study."""
    return import_module(f"{_package(folder.parent)}.{folder.name}.{module}")


def _shipped() -> Path:
    """Return the folder of the studies that ship; it does not exist where they were taken away."""
    return shipped_folder("studies").resolve()


def _package(parent: Path) -> str:
    """Make the folders below a folder importable; return the name of their package."""
    name = PACKAGE
    if parent != _shipped():
        name = f"{PACKAGE}_{sha256(str(parent).encode()).hexdigest()[:12]}"
    if name not in sys.modules:
        spec = ModuleSpec(name, None, is_package=True)
        spec.submodule_search_locations = [str(parent)]
        sys.modules[name] = module_from_spec(spec)
    return name


_package(_shipped())
