"""Which tests of a room reach which lines, measured once, and runs of chosen tests in a fresh process."""

import ast
import importlib
import importlib.abc
import importlib.util
import json
import sys
import tempfile
from collections import defaultdict
from collections.abc import Callable
from functools import cache, partial
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from benchmarks.mutant_places import (
    ROOT,
    Mutant,
    callers,
    classes_with,
    home,
    kernels,
    lines,
    lines_of_body,
    mutate,
    parse_file,
)
from benchmarks.mutant_process import outcome, run_in_copy
from benchmarks.slowest_tests import processor_time

if TYPE_CHECKING:
    import coverage

OPTIONS = [
    *("-n", "0", "-q", "-p", "no:cacheprovider", "-p", "no:unraisableexception"),
    *("-W", "ignore::pytest.PytestAssertRewriteWarning"),
]
FIXTURE = "fixture:"
KILLED_OUTCOMES = ("killed", "endless")

Run = Callable[..., int]
"""Runs tests with or without a change, notes the one that fails in a file, and gives pytest's exit code."""


class Recorder:
    """Plugin that names each test to coverage, and notes its processor time and its shared fixtures."""

    def __init__(self, measurement: "coverage.Coverage") -> None:
        self.measurement = measurement
        self.seconds: dict[str, float] = {}
        self.fixtures: dict[str, list[str]] = {}
        self.failed: set[str] = set()
        self.current = ""

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item):
        self.current = item.nodeid
        self.fixtures[item.nodeid] = list(getattr(item, "fixturenames", []))
        self.measurement.switch_context(item.nodeid)
        start = processor_time()
        yield
        self.seconds[item.nodeid] = processor_time() - start
        self.measurement.switch_context("")

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef):
        if fixturedef.scope == "function":
            return (yield)
        self.measurement.switch_context(FIXTURE + fixturedef.argname)
        try:
            return (yield)
        finally:
            self.measurement.switch_context(self.current)

    def pytest_runtest_logreport(self, report):
        if report.failed:
            self.failed.add(report.nodeid)


class TestSelection:
    """Plugin that runs the chosen tests, in their order, and notes the one that fails."""

    def __init__(self, names: list[str], note: Path | None = None) -> None:
        self.rank = {name: number for number, name in enumerate(names)}
        self.note = note

    def pytest_collection_modifyitems(self, items):
        items[:] = sorted(
            (item for item in items if item.nodeid in self.rank), key=lambda item: self.rank[item.nodeid]
        )

    def pytest_runtest_logreport(self, report):
        if report.failed and self.note is not None:
            self.note.write_text(report.nodeid)


class Reach:
    """Tests by the lines that they reach; those of a change take `budget` [s] of processor time at most."""

    def __init__(self, record: dict, budget: float) -> None:
        self.budget = budget
        self.seconds: dict[str, float] = record["seconds"]
        self.lines: dict[str, dict[str, list[str]]] = record["lines"]
        self.fixtures: dict[str, list[str]] = {
            name: fixtures for name, fixtures in record["fixtures"].items() if name in self.seconds
        }

    def knows(self, mutant: Mutant) -> bool:
        """Whether the tests of a room were measured, if it has a folder of tests."""
        folder = f"tests/{mutant.file.split('/')[1]}"
        return not (ROOT / folder).is_dir() or any(name.startswith(f"{folder}/") for name in self.seconds)

    def tests_at(self, file: str, numbers: range) -> set[str]:
        """Tests that reach any of some lines of a file, themselves or by a fixture."""
        contexts_of_line = self.lines.get(file, {})
        contexts = {name for number in numbers for name in contexts_of_line.get(str(number), [])}
        shared = {name.removeprefix(FIXTURE) for name in contexts if name.startswith(FIXTURE)}
        direct = {name for name in contexts if name in self.seconds}
        return direct | {test for test, names in self.fixtures.items() if shared.intersection(names)}

    def tests(self, mutant: Mutant) -> list[str]:
        """Tests that reach a change, quick ones first, and then the others of their files."""
        place = home(mutant)
        first = set()
        if place.is_in_body:
            first = self.tests_at(mutant.file, lines(place.statement))
        elif place.function is not None:
            first = self.tests_at(mutant.file, lines_of_body(place.function))
        names = _names(mutant)
        plain, kernel_users = callers(names)
        for file, function in plain:
            first |= self.tests_at(file, lines_of_body(function))
        if names:
            classes = classes_with(mutant.file, names)
            words = frozenset({*names, *(name for _, name in kernel_users), *classes, Path(mutant.file).stem})
            first |= {test for test in self.seconds if _mentions(file_of(test), words)}
        if not first and (not place.is_in_body or names):
            bodies = [part for part in ast.walk(parse_file(mutant.file)) if isinstance(part, ast.FunctionDef)]
            first = {name for body in bodies for name in self.tests_at(mutant.file, lines_of_body(body))}
            first = first or set(self.seconds)
        files = {file_of(name) for name in first}
        others_of_files = {name for name in self.seconds if file_of(name) in files} - first
        near = partial(_nearness, Path(mutant.file))
        return self._sort_by_cost(*self._limit_to_budget(first, others_of_files, near=near), near=near)

    def _limit_to_budget(self, *groups: set[str], near: Callable[[str], int]) -> list[set[str]]:
        """Of each group the nearest and quickest tests, up to the longest time.

        A share that is too low, never too high, comes of it.
        """
        budget_left, groups_kept = self.budget, []
        for group in groups:
            fitting = set()
            for name in sorted(group, key=lambda name: (near(name), self.seconds[name], name)):
                if self.seconds[name] <= budget_left or not (groups_kept or fitting):
                    fitting.add(name)
                    budget_left -= self.seconds[name]
            groups_kept.append(fitting)
        return groups_kept

    def _sort_by_cost(self, *groups: set[str], near: Callable[[str], int]) -> list[str]:
        """Tests group by group, near and cheap files first."""
        names = []
        for group in groups:
            cost: dict[str, float] = defaultdict(float)
            for name in group:
                cost[file_of(name)] += self.seconds[name]
            names += sorted(
                group, key=lambda name: (near(name), cost[file_of(name)], file_of(name), self.seconds[name])
            )
        return names


def _nearness(source: Path, test: str) -> int:
    """Zero for tests that are named as a module or stand in it, then by the folders that they share."""
    file = Path(file_of(test))
    if file.name == f"test_{source.name}" or file == source:
        return 0
    folders = zip(source.parts[1:-1], file.parts[1:-1], strict=False)
    shared = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], folders))
    return len(source.parts) - shared


def merge_records(records: list[dict]) -> dict:
    """Put together which test reaches what, of several rooms whose tests were run one after the other."""
    record_of_all: dict = {"seconds": {}, "fixtures": {}, "lines": {}}
    for record in records:
        for name in ("seconds", "fixtures"):
            record_of_all[name] |= record[name]
        for file, lines_of_file in record["lines"].items():
            tests_of_line = record_of_all["lines"].setdefault(file, {})
            for line, names in lines_of_file.items():
                tests_of_line.setdefault(line, []).extend(names)
    return record_of_all


def file_of(test: str) -> str:
    return test.partition("::")[0]


@cache
def _mentions(file: str, words: frozenset[str]) -> bool:
    """Whether a file of tests names compiled code, or the module in which it stands, as an effect is."""
    nodes = list(ast.walk(parse_file(file)))
    words_of_file = {getattr(node, "id", getattr(node, "attr", "")) for node in nodes}
    words_of_file |= {
        node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
    return file.startswith("tests/") and not words.isdisjoint(words_of_file)


def _names(mutant: Mutant) -> set[str]:
    """Names by which code is used that coverage does not see: kernels, and what stands outside functions."""
    place = home(mutant)
    if place.function is not None and any(
        file == mutant.file and kernel.lineno == place.function.lineno
        for file, kernel in kernels().get(place.function.name, [])
    ):
        return {place.function.name}
    if place.function is not None:
        return set()
    targets = getattr(place.statement, "targets", [getattr(place.statement, "target", None)])
    return {
        part.id for target in targets if target for part in ast.walk(target) if isinstance(part, ast.Name)
    }


def stale(mutant: Mutant) -> set[str]:
    """Files whose kernels must be compiled anew, because they hold or call the changed code."""
    names = _names(mutant)
    if not names:
        return set()
    return {mutant.file} | {file for file, _ in callers(names)[1]}


def measure_reach(room: str, tests: list[str]) -> dict:
    """Run the tests of a room once; which lines each reaches, and the processor time it takes [s]."""
    with tempfile.TemporaryDirectory() as name:
        answer = Path(name) / "reach.json"
        code = run_in_copy(lambda: _measure(tests, answer))
        if code != 0:
            sys.exit(f"the tests of {room} could not be run: code {code}")
        return json.loads(answer.read_text())


def _measure(tests: list[str], answer: Path) -> int:
    import coverage

    measurement = coverage.Coverage(data_file=None, source=[str(ROOT / "reliab")], config_file=False)
    recorder = Recorder(measurement)
    measurement.start()
    code = pytest.main([*OPTIONS, *tests], plugins=[recorder])
    measurement.stop()
    data = measurement.get_data()
    contexts = {
        str(Path(file).relative_to(ROOT)): data.contexts_by_lineno(file) for file in data.measured_files()
    }
    for name in recorder.failed:
        print(f"{name} fails without any change and takes no part")
        recorder.seconds.pop(name, None)
    record = {"seconds": recorder.seconds, "fixtures": recorder.fixtures, "lines": contexts}
    answer.write_text(json.dumps(record))
    return 0 if code == pytest.ExitCode.TESTS_FAILED else int(code)


def judge(mutant: Mutant, names: list[str], seconds: float) -> str:
    """Run tests on a change, imported anew, and say what came of it, as `outcome`."""
    if not names:
        return "unreached"
    return judge_run(
        names, lambda some, note, is_changed: _try(mutant, some, note, is_changed=is_changed), seconds
    )


def judge_run(names: list[str], run: Run, seconds: float) -> str:
    """Run tests with a change; if they fail, up to the one that failed also without it.

    A change counts as noticed only if these tests pass without it, in the same order, the same way and
    within the same limit; else the outcome is "unsound".
    """
    with tempfile.TemporaryDirectory() as folder:
        note = Path(folder) / "failed"
        answer = outcome(run_in_copy(lambda: run(names, note, is_changed=True), seconds))
        if answer not in KILLED_OUTCOMES:
            return answer
        # without a note nothing was collected, or nothing ended
        failure = note.read_text() if note.exists() else names[0 if answer == "killed" else -1]
        first_tests = names[: names.index(failure) + 1]
        return (
            answer
            if run_in_copy(lambda: run(first_tests, note, is_changed=False), seconds) == 0
            else "unsound"
        )


def _try(mutant: Mutant, names: list[str], note: Path, *, is_changed: bool) -> int:
    for name in [name for name in sys.modules if name.partition(".")[0] in ("reliab", "blind_campaigns")]:
        del sys.modules[name]
    sys.meta_path.insert(
        0, _MutantImporter(mutant, mutate(mutant) if is_changed else parse_file(mutant.file))
    )
    forget_kernels({str(ROOT / file) for file in stale(mutant)})
    importlib.import_module(module_of(mutant.file))
    files = list(dict.fromkeys(map(file_of, names)))
    return int(pytest.main([*OPTIONS, "-x", *files], plugins=[TestSelection(names, note)]))


def module_of(file: str) -> str:
    return ".".join(Path(file).with_suffix("").parts).removesuffix(".__init__")


def forget_kernels(sources: set[str]) -> None:
    """Compile the kernels of some files anew, and keep none of them on disk."""
    from numba.core.caching import Cache

    load, save = Cache.load_overload, Cache.save_overload

    def is_stale(cache):
        return cache._py_func.__code__.co_filename in sources  # noqa: SLF001 - Numba has no other way

    def load_fresh(cache, *arguments):
        return None if is_stale(cache) else load(cache, *arguments)

    def save_fresh(cache, *arguments):
        return None if is_stale(cache) else save(cache, *arguments)

    Cache.load_overload, Cache.save_overload = load_fresh, save_fresh


class _MutantImporter(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports the changed module; what is on disk stays as it is."""

    def __init__(self, mutant: Mutant, tree: ast.Module) -> None:
        self.name, self.path, self.tree = module_of(mutant.file), ROOT / mutant.file, tree

    def find_spec(self, fullname, path=None, target=None):  # noqa: ARG002 - importlib prescribes them
        if fullname != self.name:
            return None
        return importlib.util.spec_from_file_location(fullname, self.path, loader=self)

    def create_module(self, spec):  # noqa: ARG002 - importlib prescribes it
        return None

    def exec_module(self, module):
        exec(compile(self.tree, str(self.path), "exec"), module.__dict__)  # noqa: S102 - our own source
