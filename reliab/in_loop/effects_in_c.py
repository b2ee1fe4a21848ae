"""Effects in C: the kernels of the library's effects, written from their own source, one function each.

A kernel is a short function of numbers in Python; every value of it is a double here. What is translated is
what the kernels of the library consist of: assignments, conditions, loops over a range, arithmetic, and the
functions of `math` that C has too. An effect of another package is translated as well, or refused by name.
"""

import ast
import inspect
import math
import textwrap
from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any, Final

from reliab.core.errors import InputError
from reliab.effects.effect import Effect, SteppedEffect
from reliab.effects.kernel import Kernel

_NUMBERS: Final = (0, 3, 4)  # places of the arguments that are arrays: motion, coefficients, state
_CONSTANT: Final = (0, 1, 2, 3)  # places of those that a kernel does not own, of which motion may change
_OPERATORS: Final = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.And: "&&",
    ast.Or: "||",
    ast.USub: "-",
    ast.Not: "!",
}
_FUNCTIONS: Final = {"abs": "fabs", "min": "smaller", "max": "larger", "int": "trunc"}
_MATH_FUNCTIONS: Final = {"tanh", "exp", "pow", "sqrt", "sin", "cos", "tan", "atan", "log", "fabs", "floor"}


class _NotTranslatedError(Exception):
    """A kernel holds something that has no form in C here."""


def functions_in_c(effects: Sequence[Effect]) -> list[str]:
    """Write the kernels of effects as functions `effect_0`, `effect_1`, ….

    Raises InputError, with its name, where an effect has no kernel or one that cannot be written in C.
    """
    return [_write_effect(effect, f"effect_{place}") for place, effect in enumerate(effects)]


def _write_effect(effect: Effect, name: str) -> str:
    try:
        return _Function(_kernel_of(effect), name).text
    except (_NotTranslatedError, OSError, SyntaxError) as reason:
        raise InputError(
            f"A monitor in a loop computes effects whose step has a form in C, and {effect.name} has none",
            value=str(reason),
            remedy="Leave it out of the model, or follow the test with `reliab monitor --model`",
        ) from reason


def _kernel_of(effect: Effect) -> Kernel:
    if not isinstance(effect, SteppedEffect):
        raise _NotTranslatedError("it has no step")
    return effect.kernel


class _Function:
    """A kernel as a function in C."""

    def __init__(self, kernel: Kernel, name: str) -> None:
        function = inspect.unwrap(kernel.function)
        tree = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
        if not isinstance(tree, ast.FunctionDef) or len(tree.args.args) != len(_CONSTANT) + 1:
            raise _NotTranslatedError("its kernel is not a plain function of five arguments")
        self._globals: dict[str, Any] = {**vars(math), **function.__globals__}
        self._math = {key for key, value in function.__globals__.items() if value is math}
        self._arguments = [argument.arg for argument in tree.args.args]
        self._locals: dict[str, None] = {}
        body = [line for statement in tree.body for line in self._statement(statement, 1)]
        variables = [f"    double {', '.join(f'{local} = 0.0' for local in self._locals)};"] * bool(
            self._locals
        )
        void_uses = [f"    (void){argument};" for argument in self._arguments]
        self.text = "\n".join([self._head(name), "{", *variables, *void_uses, *body, "}"])

    def _head(self, name: str) -> str:
        kinds = ("double *", "double ", "double ", "const double *", "double *")
        pairs = zip(kinds, self._arguments, strict=True)
        return f"static double {name}({', '.join(kind + argument for kind, argument in pairs)})"

    def _statement(self, node: ast.stmt, depth: int) -> list[str]:
        space = "    " * depth
        writers: dict[type[ast.AST], Callable[[Any, int], list[str]]] = {
            ast.Assign: self._assign,
            ast.AugAssign: self._change,
            ast.If: self._branch,
            ast.For: self._loop,
        }
        writer = writers.get(type(node))
        if writer is not None:
            return [space + line for line in writer(node, depth)]
        if isinstance(node, ast.Return) and node.value is not None:
            return [f"{space}return {self._value(node.value)};"]
        if isinstance(node, ast.Break):
            return [f"{space}break;"]
        raise _NotTranslatedError(f"`{ast.unparse(node).splitlines()[0]}` has no form in C")

    def _block(self, statements: list[ast.stmt]) -> list[str]:
        return [line for statement in statements for line in self._statement(statement, 1)]

    def _assign(self, node: ast.Assign, _depth: int) -> list[str]:
        if not isinstance(node.value, ast.Tuple):
            targets = " = ".join(self._target(target) for target in node.targets)
            return [f"{targets} = {self._value(node.value)};"]
        (targets_of_all,) = node.targets
        if not isinstance(targets_of_all, ast.Tuple):
            raise _NotTranslatedError(f"`{ast.unparse(node)}` has no form in C")
        # all values before any target: a value may hold a target's old one
        values = [
            f"const double value_{k} = {self._value(value)};" for k, value in enumerate(node.value.elts)
        ]
        assignments = [f"{self._target(target)} = value_{k};" for k, target in enumerate(targets_of_all.elts)]
        return ["{", *(f"    {line}" for line in values + assignments), "}"]

    def _change(self, node: ast.AugAssign, _depth: int) -> list[str]:
        return [f"{self._target(node.target)} {self._operator(node.op)}= {self._value(node.value)};"]

    def _branch(self, node: ast.If, _depth: int) -> list[str]:
        else_lines = ["} else {", *self._block(node.orelse)] if node.orelse else []
        condition = self._value(node.test)  # a compiler may refuse a comparison in two pairs of parentheses
        if not isinstance(node.test, ast.Compare):
            condition = f"({condition})"
        return [f"if {condition} {{", *self._block(node.body), *else_lines, "}"]

    def _loop(self, node: ast.For, _depth: int) -> list[str]:
        count = node.iter
        if not (isinstance(count, ast.Call) and ast.unparse(count.func) == "range" and len(count.args) == 1):
            raise _NotTranslatedError(f"`{ast.unparse(count)}` is not a range from zero")
        place, end = self._target(node.target), self._value(count.args[0])
        return [f"for ({place} = 0.0; {place} < {end}; {place} += 1.0) {{", *self._block(node.body), "}"]

    def _target(self, node: ast.expr) -> str:
        if isinstance(node, ast.Subscript):
            return self._element(node)
        if not isinstance(node, ast.Name):
            raise _NotTranslatedError(f"`{ast.unparse(node)}` cannot be assigned to")
        self._locals[node.id] = None
        return node.id

    def _element(self, node: ast.Subscript) -> str:
        arrays = [self._arguments[place] for place in _NUMBERS]
        place = node.slice
        if not (isinstance(place, ast.Constant) and isinstance(place.value, int)) or (
            ast.unparse(node.value) not in arrays
        ):
            raise _NotTranslatedError(f"`{ast.unparse(node)}` is not an element with a fixed number")
        return f"{ast.unparse(node.value)}[{place.value}]"

    def _operator(self, node: ast.AST) -> str:
        if type(node) not in _OPERATORS:
            raise _NotTranslatedError(f"it uses {type(node).__name__}")
        return _OPERATORS[type(node)]

    def _value(self, node: ast.expr) -> str:
        writers: dict[type[ast.AST], Callable[[Any], str]] = {
            ast.Constant: self._number,
            ast.Subscript: self._element,
            ast.Name: lambda name: self._symbol(name.id),
            ast.Attribute: self._constant_of_math,
            ast.BinOp: self._arithmetic,
            ast.UnaryOp: lambda sign: f"({self._operator(sign.op)}{self._value(sign.operand)})",
            ast.BoolOp: lambda link: (
                f"({f' {self._operator(link.op)} '.join(map(self._value, link.values))})"
            ),
            ast.Compare: self._comparison,
            ast.IfExp: self._choice,
            ast.Call: self._call,
        }
        writer = writers.get(type(node))
        if writer is None:
            raise _NotTranslatedError(f"`{ast.unparse(node)}` has no form in C")
        return writer(node)

    def _number(self, node: ast.Constant) -> str:
        if not isinstance(node.value, float | int):
            raise _NotTranslatedError(f"`{ast.unparse(node)}` is not a number")
        return repr(float(node.value))

    def _constant_of_math(self, node: ast.Attribute) -> str:
        if ast.unparse(node.value) not in self._math:
            raise _NotTranslatedError(f"`{ast.unparse(node)}` has no form in C")
        return self._symbol(node.attr)

    def _arithmetic(self, node: ast.BinOp) -> str:
        left_operand, right_operand = self._value(node.left), self._value(node.right)
        if isinstance(node.op, ast.Pow):
            return f"pow({left_operand}, {right_operand})"
        return f"({left_operand} {self._operator(node.op)} {right_operand})"

    def _comparison(self, node: ast.Compare) -> str:
        values = [self._value(side) for side in (node.left, *node.comparators)]
        pairs = zip(values, node.ops, values[1:], strict=False)
        return f"({' && '.join(f'{a} {self._operator(sign)} {b}' for a, sign, b in pairs)})"

    def _choice(self, node: ast.IfExp) -> str:
        return f"({self._value(node.test)} ? {self._value(node.body)} : {self._value(node.orelse)})"

    def _call(self, node: ast.Call) -> str:
        if node.keywords:
            raise _NotTranslatedError(f"`{ast.unparse(node)}` has no form in C")
        function, values = self._write_call(node.func), [self._value(value) for value in node.args]
        if function in ("smaller", "larger"):  # of two values each
            return reduce(lambda first, second: f"{function}({first}, {second})", values)
        return f"{function}({', '.join(values)})"

    def _symbol(self, name: str) -> str:
        if name in self._locals or name in self._arguments:
            return name
        value = self._globals.get(name)
        if isinstance(value, float | int):
            return repr(float(value))
        raise _NotTranslatedError(f"`{name}` is not a number")

    def _write_call(self, node: ast.expr) -> str:
        if isinstance(node, ast.Name) and node.id in _FUNCTIONS and node.id not in self._globals:
            return _FUNCTIONS[node.id]
        if (
            isinstance(node, ast.Attribute)
            and ast.unparse(node.value) in self._math
            and node.attr in _MATH_FUNCTIONS
        ):
            return node.attr
        raise _NotTranslatedError(f"`{ast.unparse(node)}` is not a function that C has")
