"""Names that benchmarks import from each other and from the tests exist; no other test runs a benchmark."""

import ast
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parent
FOLDERS = [BENCHMARKS.parent, BENCHMARKS.parent / "assessment", BENCHMARKS]  # in the order of paths.py


def find_helper(name):
    """Return the folder or file of a module of the tests, None of any other module."""
    places = [folder / Path(*name.split(".")) for folder in FOLDERS]
    candidates = (path for place in places for path in (place, place.with_suffix(".py")))
    return next((path for path in candidates if path.exists()), None)


def defined_names(helper):
    """Return the names at the top level of a module, or the modules of a folder."""
    if helper.is_dir():
        return {path.stem for path in helper.iterdir()}
    names = set()
    for node in ast.parse(helper.read_text(encoding="utf-8")).body:
        match node:
            case ast.FunctionDef() | ast.ClassDef():
                names.add(node.name)
            case ast.Import() | ast.ImportFrom():
                names |= {alias.asname or alias.name.partition(".")[0] for alias in node.names}
            case _:
                stored = (part for part in ast.walk(node) if isinstance(part, ast.Name))
                names |= {part.id for part in stored if isinstance(part.ctx, ast.Store)}
    return names


@pytest.mark.default_cases(100)
@pytest.mark.parametrize("script", sorted(BENCHMARKS.glob("*.py")), ids=lambda path: path.stem)
def test_what_a_script_imports_from_tests_exists(script):
    for node in ast.walk(ast.parse(script.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and (helper := find_helper(node.module)):
            assert {alias.name for alias in node.names} <= defined_names(helper)
