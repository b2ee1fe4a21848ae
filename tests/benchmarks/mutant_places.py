"""Places of the package where something small can be changed, and what uses the changed code.

Two kinds of changes: `operators` (an operator, a comparison or a number is another), and `statements` (a call
whose result nobody takes is left out, a guard never or always fires, branches or arguments are exchanged, a
term or a factor is dropped).
"""

import ast
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
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

# functions whose arguments may stand in any order
_SYMMETRIC = {"min", "max", "minimum", "maximum", "hypot", "isclose"}

Line = tuple[str, int]
Change = tuple[ast.expr | ast.stmt, str, Callable[[], None]]
"""A node, the change in words, and what makes it."""

KINDS = ("operators", "statements")


@dataclass(frozen=True)
class Mutant:
    """A file, a kind of change, the number of a place of this kind in it, and the change in words."""

    file: str
    kind: str
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
    is_in_body: bool


def mutants(room: str, kind: str = "operators") -> list[Mutant]:
    """Every change of a kind in a room, but none within an error that is raised."""
    return [
        Mutant(file, kind, place, node.lineno, change)
        for file in files(room)
        for place, (node, change, _) in enumerate(
            _places(ast.parse((ROOT / file).read_text(encoding="utf-8")), kind)
        )
    ]


@cache
def files(room: str = "") -> list[str]:
    """Sources of a room, from the root."""
    return [str(path.relative_to(ROOT)) for path in sorted((ROOT / "reliab" / room).rglob("*.py"))]


def mutate(mutant: Mutant) -> ast.Module:
    """The module with the change; every line keeps its number."""
    tree = ast.parse((ROOT / mutant.file).read_text(encoding="utf-8"))
    list(_places(tree, mutant.kind))[mutant.place][2]()
    return ast.fix_missing_locations(tree)


def _places(tree: ast.AST, kind: str) -> Iterator[Change]:
    """Nodes that can be changed, in an order that is the same every time."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise):
            for part in ast.walk(node):
                part.skipped = True  # type: ignore[attr-defined]
    for node in ast.walk(tree):
        if not getattr(node, "skipped", False):
            yield from {"operators": _operators, "statements": _statements}[kind](node)


def _operators(node: ast.AST) -> Iterator[Change]:
    match node:
        case ast.BinOp(op=operator) | ast.UnaryOp(op=operator) | ast.BoolOp(op=operator):
            if (opposite := _OPERATORS.get(type(operator))) is not None:
                yield node, _words(operator, opposite), partial(setattr, node, "op", opposite())
        case ast.Compare(ops=[operator]) if type(operator) in _OPERATORS:
            opposite = _OPERATORS[type(operator)]
            yield node, _words(operator, opposite), partial(setattr, node, "ops", [opposite()])
        case ast.Constant(value=float() | int() as value) if not isinstance(value, bool):
            another = _another(value)
            yield node, f"{value} to {another}", partial(setattr, node, "value", another)


def _statements(node: ast.AST) -> Iterator[Change]:
    match node:
        case ast.Expr(value=ast.Call()):
            yield node, "left out", partial(setattr, node, "value", ast.Constant(None))
        case ast.If(body=[ast.Raise(), *_]):
            yield node, "never refused", partial(setattr, node, "test", ast.Constant(value=False))
        case ast.If() | ast.IfExp():
            negation = ast.UnaryOp(ast.Not(), node.test)
            yield node, "branches exchanged", partial(setattr, node, "test", negation)
        case ast.Call(args=[first, second, *rest]) if _order_matters(node):
            yield node, "arguments exchanged", partial(setattr, node, "args", [second, first, *rest])
        case ast.BinOp(op=ast.Mult() | ast.Div()):
            yield node, "factor dropped", partial(setattr, node, "right", ast.Constant(1))
        case ast.BinOp(op=ast.Add() | ast.Sub()) if not isinstance(
            node.left, ast.JoinedStr | ast.Tuple | ast.List
        ):
            yield node, "term dropped", partial(setattr, node, "right", ast.Constant(0))


def _order_matters(call: ast.Call) -> bool:
    """Whether it may matter in which order the first two arguments of a call stand."""
    has_star = any(isinstance(part, ast.Starred) for part in call.args)
    are_equal = ast.dump(call.args[0]) == ast.dump(call.args[1])
    return not (has_star or are_equal or _name(call.func) in _SYMMETRIC)


def _words(operator: ast.AST, opposite: type[ast.AST]) -> str:
    return f"{type(operator).__name__} to {opposite.__name__}"


def _another(value: float) -> float:
    return value + 1 if isinstance(value, int) else 1.1 * value if value else 1.0


def home(mutant: Mutant) -> Home:
    """Innermost statement and function around a place."""
    tree = parse_file(mutant.file)
    node = list(_places(tree, mutant.kind))[mutant.place][0]
    statement, function, is_in_body = tree.body[0], None, False
    inner: ast.AST = tree
    while inner is not node:
        parent = inner
        inner = next(child for child in ast.iter_child_nodes(parent) if _holds(child, node))
        if isinstance(inner, ast.stmt):
            statement, is_in_body = inner, is_in_body or parent is function
            if isinstance(inner, ast.FunctionDef) and function is None:
                function = inner
    return Home(statement, function, is_in_body)


def _holds(tree: ast.AST, node: ast.AST) -> bool:
    return any(part is node for part in ast.walk(tree))


@cache
def parse_file(file: str) -> ast.Module:
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
    functions: dict[str, list[tuple[str, ast.FunctionDef]]] = {}
    for file in files():
        arguments = {
            word.value.id
            for node in ast.walk(parse_file(file))
            if isinstance(node, ast.Call)
            for word in node.keywords
            if word.arg == "function" and isinstance(word.value, ast.Name)
        }
        for node in ast.walk(parse_file(file)):
            if isinstance(node, ast.FunctionDef) and (node.name in arguments or _is_compiled(node)):
                functions.setdefault(node.name, []).append((file, node))
    return functions


def _is_compiled(function: ast.FunctionDef) -> bool:
    return any(isinstance(mark, ast.Name) and mark.id == "compiled" for mark in function.decorator_list)


@cache
def _users() -> dict[str, list[tuple[str, ast.FunctionDef]]]:
    """Functions of the package by the names that they mention."""
    functions: dict[str, list[tuple[str, ast.FunctionDef]]] = {}
    for file in files():
        for node in ast.walk(parse_file(file)):
            if isinstance(node, ast.FunctionDef):
                for name in {_name(part) for part in ast.walk(node)} - {""}:
                    functions.setdefault(name, []).append((file, node))
    return functions


def _name(node: ast.AST) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""


def classes_with(file: str, names: set[str]) -> set[str]:
    """Classes of a file that mention names, as an effect has its kernel."""
    return {
        node.name
        for node in ast.walk(parse_file(file))
        if isinstance(node, ast.ClassDef) and not names.isdisjoint(map(_name, ast.walk(node)))
    }


def callers(names: set[str]) -> tuple[list[tuple[str, ast.FunctionDef]], set[tuple[str, str]]]:
    """Plain functions that mention names, also through kernels; and files and names of these kernels."""
    plain: list[tuple[str, ast.FunctionDef]] = []
    compiled_functions: set[tuple[str, str]] = set()
    waiting, known_names = sorted(names), set(names)
    while waiting:
        for file, function in _users().get(waiting.pop(), []):
            if any(function is kernel for _, kernel in kernels().get(function.name, [])):
                compiled_functions.add((file, function.name))
                if function.name not in known_names:
                    known_names.add(function.name)
                    waiting.append(function.name)
            else:
                plain.append((file, function))
    return plain, compiled_functions
