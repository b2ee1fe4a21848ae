"""The habits of CONTRIBUTING.md that a program can check: sizes, names, and no code without a user.

Sizes are limits, not aims: a module is one subject that can be told in one sentence.
"""

import ast
import itertools
import re
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from parsed import nodes, parsed

import reliab
from reliab.app.cli import application

PACKAGE = Path(reliab.__file__).parent
STUDIES = PACKAGE.parent / "studies"
DATASETS = PACKAGE.parent / "datasets"
TESTS = Path(__file__).parent
LINES_OF_A_MODULE = 500
LINES_OF_A_FUNCTION = 40
LONG_FUNCTIONS = {
    "assessment/measured_specimen/elements.py:_advance": "compiled: one branch for each kind of element",
    "simulation/hybrid_test/closed_loop.py:march": "one compiled loop",
    "simulation/linear_loop/drive_stepping.py:_track_lanes": "one compiled loop",
    "simulation/linear_loop/pole_recursion.py:_track_lanes": "one compiled loop",
}
"""Functions longer than the rule allows, and why."""


@cache
def source(path: Path) -> tuple[list[str], ast.Module]:
    text = path.read_text(encoding="utf-8")
    return text.splitlines(), parsed(path)


def modules() -> list[Path]:
    return sorted(PACKAGE.rglob("*.py"))


def functions(path: Path) -> Iterator[ast.FunctionDef]:
    yield from (node for node in nodes(path) if isinstance(node, ast.FunctionDef))


def lines_of_body(path: Path, function: ast.FunctionDef) -> int:
    """Count lines of code below the signature, without the docstring, comments and empty lines."""
    lines = source(path)[0]
    body = function.body[1:] if ast.get_docstring(function) else function.body
    code = (
        (lines[i - 1].strip() for i in range(body[0].lineno, (function.end_lineno or 0) + 1)) if body else ()
    )
    return sum(bool(line) and not line.startswith("#") for line in code)


@cache
def uses() -> Counter[str]:
    """Count how often each name is read in the package, its studies and its datasets, not only imported."""
    names: Counter[str] = Counter()
    for path in (*modules(), *STUDIES.rglob("*.py"), *DATASETS.rglob("*.py")):
        for node in nodes(path):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
                names[node.id] += 1
            elif isinstance(node, ast.Attribute):
                names[node.attr] += 1
    return names


def test_modules_are_short():
    long = {str(path.relative_to(PACKAGE)): len(source(path)[0]) for path in modules()}
    assert {path for path, lines in long.items() if lines > LINES_OF_A_MODULE} == set()


def test_functions_are_short():
    long = {
        f"{path.relative_to(PACKAGE)}:{function.name}"
        for path in modules()
        for function in functions(path)
        if lines_of_body(path, function) > LINES_OF_A_FUNCTION
    }
    assert long == set(LONG_FUNCTIONS)


def test_no_function_is_called_of():
    """A function called `of` leaves it to its reader to find out what is made of what."""
    pattern = re.compile(r"(\bdef _*|\.)of_*\(")
    files = [path for top in (PACKAGE, STUDIES, TESTS) for path in top.rglob("*.py")]
    assert [str(path) for path in files if pattern.search(path.read_text(encoding="utf-8"))] == []


COMMANDS = {command.callback.__name__ for command in application().registered_commands}


def is_command(node: ast.FunctionDef | ast.ClassDef) -> bool:
    """Tell whether the code is handed to its user: a command, or an accessor of xarray by its decorator."""
    return node.name in COMMANDS or any(
        re.search(r"\.(command|register_\w+)\(", ast.unparse(item)) for item in node.decorator_list
    )


def public_names() -> set[str]:
    """Return the names that reliab itself offers to Python users, and those that its examples import."""
    import_nodes = (
        node for path in modules() for node in ast.walk(ast.parse("\n".join(example_imports(path))))
    )
    return {
        alias.asname or alias.name
        for node in (*import_nodes, *nodes(PACKAGE / "__init__.pyi"))
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def example_imports(path: Path) -> list[str]:
    """Return the lines of examples in docstrings that import something."""
    return re.findall(r"^ *>>> (from reliab\.\S+ import .*)$", path.read_text(encoding="utf-8"), re.MULTILINE)


def test_public_code_has_a_user_in_the_package():
    names_without_use = {
        f"{path.relative_to(PACKAGE)}:{node.name}"
        for path in modules()
        for node in source(path)[1].body
        if isinstance(node, ast.FunctionDef | ast.ClassDef)
        if not (node.name.startswith("__") or is_command(node))
        if uses()[node.name] == 0 and node.name not in public_names()
    }
    assert names_without_use == set()


WRITING = frozenset({"write_text", "write_bytes", "to_csv", "to_netcdf", "savefig"})
FILES_IN_RENAMED_FOLDERS = {"report/content.py", "motions/catalogue.py"}
"""Whole folders are written under another name first."""
FILES_IN_MEMORY = {"report/style.py"}


def test_results_are_written_whole_or_not_at_all():
    """Every call that writes a file stands in a `with written_whole(…)`, but for those named above."""
    exempt = FILES_IN_RENAMED_FOLDERS | FILES_IN_MEMORY
    stray = {
        f"{path.relative_to(PACKAGE)}:{call.lineno}"
        for path in PACKAGE.rglob("*.py")
        if str(path.relative_to(PACKAGE)) not in exempt
        for call in _find_unguarded_calls(source(path)[1])
    }
    assert stray == set()


def _find_unguarded_calls(node: ast.AST) -> Iterator[ast.Call]:
    if isinstance(node, ast.With) and any("written_whole" in ast.unparse(item) for item in node.items):
        return
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in WRITING:
        yield node
    for child in ast.iter_child_nodes(node):
        yield from _find_unguarded_calls(child)


PARSING = frozenset({"tomllib.load", "tomllib.loads", "json.load", "json.loads"})
OWN_TEXTS = {"sweep/run.py", "study/steps.py", "desk/work.py"}
"""The journal of a store, whose entries are digests, and JSON from memory."""


def test_descriptions_of_users_are_parsed_within_bounds():
    parsers = {
        str(path.relative_to(PACKAGE))
        for path in PACKAGE.rglob("*.py")
        for node in nodes(path)
        if isinstance(node, ast.Call) and ast.unparse(node.func) in PARSING
    }
    assert parsers == {"core/described_files.py"} | OWN_TEXTS


_PERCENT_ALONE = re.compile(r"(?<!±)(?<!\+- )\b\d+%(?![\w;])")


def percent_signs(path: Path) -> Iterator[str]:
    """Per cent that is written without its space; `1±1%` is how a user may type a deviation."""
    for node in nodes(path):
        if isinstance(node, ast.FormattedValue) and node.format_spec is not None:
            if ast.unparse(node.format_spec).rstrip("'\"").endswith("%"):
                yield f"{path.name}:{node.lineno}"
        elif isinstance(node, ast.JoinedStr):
            for value, text in itertools.pairwise(node.values):
                if isinstance(value, ast.FormattedValue) and ast.unparse(text).startswith("'%"):
                    yield f"{path.name}:{node.lineno}"
        elif isinstance(node, ast.Constant) and _PERCENT_ALONE.search(str(node.value)):
            yield f"{path.name}:{node.lineno}"


def test_percent_signs_stand_after_a_space():
    assert [sign for path in modules() for sign in percent_signs(path)] == []
