"""Dependencies point downwards only, and nowhere in a circle."""

import ast
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from parsed import nodes

import reliab

PACKAGE = Path(reliab.__file__).parent
ROOMS = (
    "desk",
    "app",
    "study",
    "report",
    "discrepancy",
    "explore",
    "validation",
    "rig",
    "in_loop",
    "assessment",
    "criterion",
    "sampling",
    "sweep",
    "recordings",
    "tracking",
    "simulation",
    "structures",
    "effects",
    "motions",
    "signals",
    "core",
)
NUMERIC_CORE = (
    *("signals", "motions", "effects", "structures", "simulation", "tracking"),
    "assessment/rebuilt_error",
)
GROUND = {"version"}
"""Files beside the rooms that every room may import, and that import no room."""
DOORS = {"__init__", "__main__"}
"""Files beside the rooms through which users enter."""


def module_file(module_name: str) -> Path | None:
    """Return the file of a module or package of reliab; None for everything else."""
    parts = module_name.split(".")
    if parts[0] != "reliab":
        return None
    path = PACKAGE.joinpath(*parts[1:])
    module, package = path.with_suffix(".py"), path / "__init__.py"
    if path != PACKAGE and module.is_file():
        return module
    return package if package.is_file() else None


@cache
def files_of_imports(path: Path) -> frozenset[Path]:
    """Return every file of reliab that a file imports, at its top or late, inside a function."""
    files: set[Path | None] = set()
    for node in nodes(path):
        if isinstance(node, ast.ImportFrom) and node.module:
            submodules = (module_file(f"{node.module}.{alias.name}") for alias in node.names)
            files.update(file or module_file(node.module) for file in submodules)
        elif isinstance(node, ast.Import):
            files.update(module_file(alias.name) for alias in node.names)
    return frozenset(file for file in files if file is not None and file != path)


def part_of(path: Path) -> str:
    """Return the room of a file, or the file's own name where it stands beside the rooms."""
    first, *deeper = path.relative_to(PACKAGE).parts
    return first if deeper else path.stem


def modules() -> list[Path]:
    return sorted(PACKAGE.rglob("*.py"))


def test_the_package_knows_no_study():
    """Every study could be deleted; what a command offers of one is imported by name when it is asked for."""
    for path in modules():
        for node in nodes(path):
            if isinstance(node, ast.Import | ast.ImportFrom):
                assert "reliab_studies" not in ast.unparse(node), path


@pytest.mark.parametrize("room", ROOMS)
def test_room_imports_nothing_from_above(room):
    rooms_below = {*ROOMS[ROOMS.index(room) :], *GROUND}
    for path in sorted((PACKAGE / room).rglob("*.py")):
        assert {part_of(file) for file in files_of_imports(path)} <= rooms_below, path


@pytest.mark.parametrize("name", sorted(GROUND))
def test_shared_files_import_no_room(name):
    assert {part_of(file) for file in files_of_imports(PACKAGE / f"{name}.py")} <= GROUND


def neighbours() -> Iterator[tuple[Path, str, str]]:
    """Yield the folder and two of its files or folders of which the first imports something of the second."""
    for path in modules():
        for file in files_of_imports(path):
            ours, theirs = path.relative_to(PACKAGE).parts, file.relative_to(PACKAGE).parts
            shared = next(i for i, (a, b) in enumerate(zip(ours, theirs, strict=False)) if a != b)
            yield PACKAGE.joinpath(*ours[:shared]), ours[shared], theirs[shared]


def test_neither_files_nor_folders_import_one_another_in_a_circle():
    drawings: dict[Path, dict[str, set[str]]] = {}
    for folder, user, imported_file in neighbours():
        drawings.setdefault(folder, {}).setdefault(user, set()).add(imported_file)
    for folder, drawing in drawings.items():
        try:
            TopologicalSorter(drawing).prepare()
        except CycleError as error:
            pytest.fail(f"{folder}: {' -> '.join(reversed(error.args[1]))}")


@pytest.mark.parametrize(
    "room",
    NUMERIC_CORE,
)
def test_numeric_core_does_not_speak_of_labels(room):
    for path in sorted((PACKAGE / room).rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        assert "import xarray" not in source, path
        assert "import pandas" not in source, path


def test_every_room_is_listed():
    rooms = {path.name for path in PACKAGE.iterdir() if path.is_dir() and any(path.rglob("*.py"))}
    assert rooms == set(ROOMS)


def test_every_file_beside_the_rooms_is_listed():
    assert {path.stem for path in PACKAGE.glob("*.py")} == GROUND | DOORS
