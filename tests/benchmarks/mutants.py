"""Change one operator or number of a room at a time, and see whether the room's own tests notice.

    python tests/benchmarks/mutants.py indices --count 20 --out mutants.jsonl

The package is copied, one place of the copy is changed, and the tests of the room run against the copy until
the first fails. Each mutant is a line of the output as soon as it is judged, so that a run that is stopped
loses nothing and one that is started again with the same seed goes on. Slow tests are left out.
"""

import argparse
import ast
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_LONGEST = 600.0
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


@dataclass(frozen=True)
class Mutant:
    """A file, the number of a place in it, and the change in words."""

    file: str
    place: int
    line: int
    change: str


def mutants(room: str) -> list[Mutant]:
    """Every change of a room: operators, comparisons and numbers, but none within an error that is raised."""
    return [
        Mutant(str(path.relative_to(ROOT)), place, node.lineno, change)
        for path in sorted((ROOT / "reliab" / room).rglob("*.py"))
        for place, (node, change) in enumerate(_places(ast.parse(path.read_text(encoding="utf-8"))))
    ]


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


def mutated(source: str, place: int) -> str:
    """The source with the change at a place."""
    tree = ast.parse(source)
    node, _ = list(_places(tree))[place]
    if isinstance(node, ast.Constant):
        node.value = _another(node.value)
    elif isinstance(node, ast.Compare):
        node.ops = [_OPERATORS[type(node.ops[0])]()]
    else:
        node.op = _OPERATORS[type(node.op)]()
    return ast.unparse(tree)


def judge(mutant: Mutant, room: str, copy: Path) -> str:
    """Run the room's tests against the copy with the change: killed, survived or slow."""
    path = copy / mutant.file
    sound = path.read_text(encoding="utf-8")
    path.write_text(mutated(sound, mutant.place), encoding="utf-8")
    arguments = ["-n", "0", "-x", "-q", "-p", "no:cacheprovider", f"tests/{room}", f"reliab/{room}"]
    try:
        done = subprocess.run(  # noqa: S603 - pytest on the copy
            [sys.executable, "-m", "pytest", *arguments],
            cwd=copy,
            env={**os.environ, "PYTHONPATH": str(copy)},
            capture_output=True,
            timeout=_LONGEST,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return "slow"
    finally:
        path.write_text(sound, encoding="utf-8")
    return "survived" if done.returncode == 0 else "killed"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("room")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=17)
    parser.add_argument("--out", type=Path, default=Path("mutants.jsonl"))
    options = parser.parse_args()
    everything = mutants(options.room)
    chosen = random.Random(options.seed).sample(everything, min(options.count, len(everything)))  # noqa: S311
    lines = options.out.read_text().splitlines() if options.out.exists() else []
    judged = {(row["file"], row["place"]): row["outcome"] for row in map(json.loads, lines)}
    with tempfile.TemporaryDirectory() as name:
        copy = Path(name)
        for part in ("reliab", "tests", "datasets", "studies", "pyproject.toml"):
            whole = ROOT / part
            if whole.is_dir():
                shutil.copytree(whole, copy / part, ignore=shutil.ignore_patterns("*.pyc"))
            else:
                shutil.copy(whole, copy / part)
        for mutant in chosen:
            key = (mutant.file, mutant.place)
            if key not in judged:
                judged[key] = judge(mutant, options.room, copy)
                with options.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps({**vars(mutant), "outcome": judged[key]}) + "\n")
            print(f"{judged[key]:9} {mutant.file}:{mutant.line} {mutant.change}", flush=True)
    counts = Counter(judged[mutant.file, mutant.place] for mutant in chosen)
    print(dict(counts), f"of {len(everything)} possible")


if __name__ == "__main__":
    main()
