"""Dependencies point downwards only."""

import ast
from pathlib import Path

import pytest

import reliab

PACKAGE = Path(reliab.__file__).parent
ROOMS = (
    "cli",
    "study",
    "report",
    "paper",
    "discrepancy",
    "validation",
    "criterion",
    "sampling",
    "sweep",
    "rebuilt_error",
    "boundary",
    "indices",
    "loop",
    "motions",
)


def imported_rooms(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
            names.update(f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
    return {parts[1] for name in names if (parts := name.split("."))[0] == "reliab" and len(parts) > 1}


@pytest.mark.parametrize("room", ROOMS)
def test_room_imports_nothing_from_above(room):
    above = set(ROOMS[: ROOMS.index(room)])
    for path in sorted((PACKAGE / room).rglob("*.py")):
        assert not imported_rooms(path) & above, path


@pytest.mark.parametrize("room", ["motions", "loop", "indices", "boundary", "rebuilt_error"])
def test_numeric_core_does_not_speak_of_labels(room):
    for path in sorted((PACKAGE / room).rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        assert "import xarray" not in source, path
        assert "import pandas" not in source, path


def test_every_room_is_listed():
    rooms = {path.name for path in PACKAGE.iterdir() if path.is_dir() and any(path.rglob("*.py"))}
    assert rooms == set(ROOMS)
