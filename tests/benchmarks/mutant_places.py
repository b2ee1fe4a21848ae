"""Places of the package where an operator or a number can be changed, and what uses the changed code."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_OPERATORS = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.And: ast.Or,
    ast.Or: ast.And,
    ast.USub: ast.UAdd,
}

Line = tuple[str, int]


@dataclass(frozen=True)
class Mutant:
    """A file, the number of a place in it, and the change in words."""

    file: str
    place: int
    line: int
    change: str

    @property
    def text(self) -> str:
        """The line of source that is changed."""
        return (ROOT / self.file).read_text(encoding="utf-8").splitlines()[self.line - 1].strip()


@dataclass(frozen=True)
class Home:
    """Where a place stands: its statement, and the function around it if it is in one."""

    statement: ast.stmt
    function: ast.FunctionDef | None
    in_body: bool


def mutants(room: str) -> list[Mutant]:
    """Every change of a room: operators, comparisons and numbers, but none within an error that is raised."""
    return [
        Mutant(file, place, node.lineno, change)
        for file in files(room)
        for place, (node, change) in enumerate(_places(ast.parse((ROOT / file).read_text(encoding="utf-8"))))
    ]


@cache
def files(room: str = "") -> list[str]:
    """Sources of a room, from the root."""
    return [str(path.relative_to(ROOT)) for path in sorted((ROOT / "reliab" / room).rglob("*.py"))]


def mutated(mutant: Mutant) -> ast.Module:
    """The module with the change; every line keeps its number."""
    tree = ast.parse((ROOT / mutant.file).read_text(encoding="utf-8"))
    node, _ = list(_places(tree))[mutant.place]
    if isinstance(node, ast.Constant):
        node.value = _another(node.value)
    elif isinstance(node, ast.Compare):
        node.ops = [_OPERATORS[type(node.ops[0])]()]
    else:
        node.op = _OPERATORS[type(node.op)]()
    return tree


def _places(tree: ast.AST) -> Iterator[tuple[ast.expr, str]]:
    """Nodes that can be changed, in an order that is the same every time."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise):
            for part in ast.walk(node):
                part.skipped = True  # type: ignore[attr-defined]
    for node in ast.walk(tree):
        if getattr(node, "skipped", False):
            continue
        match node:
            case ast.BinOp(op=operator) | ast.UnaryOp(op=operator) | ast.BoolOp(op=operator):
                if type(operator) in _OPERATORS:
                    yield node, f"{type(operator).__name__} to {_OPERATORS[type(operator)].__name__}"
            case ast.Compare(ops=[operator]) if type(operator) in _OPERATORS:
                yield node, f"{type(operator).__name__} to {_OPERATORS[type(operator)].__name__}"
            case ast.Constant(value=float() | int() as value) if not isinstance(value, bool):
                yield node, f"{value} to {_another(value)}"


def _another(value: float) -> float:
    return value + 1 if isinstance(value, int) else 1.1 * value if value else 1.0


def home(mutant: Mutant) -> Home:
    """Innermost statement and function around a place."""
    tree = parsed(mutant.file)
    node, _ = list(_places(tree))[mutant.place]
    statement, function, in_body = tree.body[0], None, False
    inside: ast.AST = tree
    while inside is not node:
        parent = inside
        inside = next(child for child in ast.iter_child_nodes(parent) if _holds(child, node))
        if isinstance(inside, ast.stmt):
            statement, in_body = inside, in_body or parent is function
            if isinstance(inside, ast.FunctionDef) and function is None:
                function = inside
    return Home(statement, function, in_body)


def _holds(tree: ast.AST, node: ast.AST) -> bool:
    return any(part is node for part in ast.walk(tree))


@cache
def parsed(file: str) -> ast.Module:
    return ast.parse((ROOT / file).read_text(encoding="utf-8"))


def lines(statement: ast.stmt) -> range:
    """Lines of a statement without the block that it opens."""
    body = getattr(statement, "body", None)
    last = body[0].lineno - 1 if body else statement.end_lineno or statement.lineno
    return range(statement.lineno, max(last, statement.lineno) + 1)


def lines_of_body(function: ast.FunctionDef) -> range:
    """Lines of a function below its signature."""
    return range(function.body[0].lineno, (function.end_lineno or function.lineno) + 1)


@cache
def kernels() -> dict[str, list[tuple[str, ast.FunctionDef]]]:
    """Compiled functions by name: decorated ones, and those that a `Kernel` is given."""
    by_name: dict[str, list[tuple[str, ast.FunctionDef]]] = {}
    for file in files():
        given = {
            word.value.id
            for node in ast.walk(parsed(file))
            if isinstance(node, ast.Call)
            for word in node.keywords
            if word.arg == "function" and isinstance(word.value, ast.Name)
        }
        for node in ast.walk(parsed(file)):
            if isinstance(node, ast.FunctionDef) and (node.name in given or _is_compiled(node)):
                by_name.setdefault(node.name, []).append((file, node))
    return by_name


def _is_compiled(function: ast.FunctionDef) -> bool:
    return any(isinstance(mark, ast.Name) and mark.id == "compiled" for mark in function.decorator_list)


@cache
def _users() -> dict[str, list[tuple[str, ast.FunctionDef]]]:
    """Functions of the package by the names that they mention."""
    by_name: dict[str, list[tuple[str, ast.FunctionDef]]] = {}
    for file in files():
        for node in ast.walk(parsed(file)):
            if isinstance(node, ast.FunctionDef):
                for name in {_name(part) for part in ast.walk(node)} - {""}:
                    by_name.setdefault(name, []).append((file, node))
    return by_name


def _name(node: ast.AST) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""


def callers(names: set[str]) -> tuple[list[tuple[str, ast.FunctionDef]], set[str]]:
    """Plain functions that mention names, also through kernels; and the files of these kernels."""
    plain: list[tuple[str, ast.FunctionDef]] = []
    waiting, seen, compiled_files = sorted(names), set(names), set()
    while waiting:
        for file, function in _users().get(waiting.pop(), []):
            if any(function is kernel for _, kernel in kernels().get(function.name, [])):
                compiled_files.add(file)
                if function.name not in seen:
                    seen.add(function.name)
                    waiting.append(function.name)
            else:
                plain.append((file, function))
    return plain, compiled_files
