"""Which tests of a room reach which lines, measured once, and runs of chosen tests in a fresh process."""

import ast
import gc
import importlib
import importlib.abc
import importlib.util
import json
import math
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from benchmarks.mutant_places import (
    ROOT,
    Mutant,
    callers,
    home,
    kernels,
    lines,
    lines_of_body,
    mutated,
    parsed,
)
from benchmarks.slowest_tests import processor_time

if TYPE_CHECKING:
    import coverage

_HEAVY = (
    *("numpy", "scipy.stats", "scipy.optimize", "scipy.signal", "scipy.integrate", "pandas", "xarray"),
    *("numba", "hypothesis", "h5py", "h5netcdf", "typst", "emcee", "pydantic", "rich", "typer"),
    *("seaborn", "zarr", "numcodecs", "hypothesis.extra.numpy"),
)
OPTIONS = [
    *("-n", "0", "-q", "-p", "no:cacheprovider", "-p", "no:unraisableexception"),
    *("-W", "ignore::pytest.PytestAssertRewriteWarning"),
]
_BUDGET = 60.0  # s of processor time for all tests of a change
_LONGEST_WAIT = 3600.0  # s on the clock for a change whose tests wait without working
FIXTURE = "fixture:"


class Recorder:
    """Plugin that names each test to coverage, and notes its processor time and its shared fixtures."""

    def __init__(self, measurement: "coverage.Coverage") -> None:
        self.measurement = measurement
        self.seconds: dict[str, float] = {}
        self.fixtures: dict[str, list[str]] = {}
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
            sys.exit(f"{report.nodeid} fails without any change")


class Chosen:
    """Plugin that runs the chosen tests, in their order."""

    def __init__(self, names: list[str]) -> None:
        self.rank = {name: number for number, name in enumerate(names)}

    def pytest_collection_modifyitems(self, items):
        items[:] = sorted(
            (item for item in items if item.nodeid in self.rank), key=lambda item: self.rank[item.nodeid]
        )


class Reach:
    """Tests of a room by the lines that they reach."""

    def __init__(self, record: dict) -> None:
        self.seconds: dict[str, float] = record["seconds"]
        self.lines: dict[str, dict[str, list[str]]] = record["lines"]
        self.fixtures: dict[str, list[str]] = record["fixtures"]

    def at(self, file: str, numbers: range) -> set[str]:
        """Tests that reach any of some lines of a file, themselves or by a fixture."""
        reached = self.lines.get(file, {})
        contexts = {name for number in numbers for name in reached.get(str(number), [])}
        shared = {name.removeprefix(FIXTURE) for name in contexts if name.startswith(FIXTURE)}
        own = {name for name in contexts if name in self.seconds}
        return own | {test for test, names in self.fixtures.items() if shared.intersection(names)}

    def tests(self, mutant: Mutant) -> list[str]:
        """Tests that reach a change, quick ones first, and then the others of their files."""
        place = home(mutant)
        first = set()
        if place.in_body:
            first = self.at(mutant.file, lines(place.statement))
        elif place.function is not None:
            first = self.at(mutant.file, lines_of_body(place.function))
        for file, function in callers(_names(mutant))[0]:
            first |= self.at(file, lines_of_body(function))
        if not first and (not place.in_body or _names(mutant)):
            bodies = [part for part in ast.walk(parsed(mutant.file)) if isinstance(part, ast.FunctionDef)]
            first = {name for body in bodies for name in self.at(mutant.file, lines_of_body(body))}
            first = first or set(self.seconds)
        files = {file_of(name) for name in first}
        rest = {name for name in self.seconds if file_of(name) in files} - first
        return self._within_budget(self._by_cost(first) + self._by_cost(rest))

    def _within_budget(self, names: list[str]) -> list[str]:
        """Tests of a change up to the longest time; a share that is too low, never too high, comes of it."""
        total = 0.0
        for number, name in enumerate(names):
            total += self.seconds[name]
            if total > _BUDGET and number:
                return names[:number]
        return names

    def _by_cost(self, names: set[str]) -> list[str]:
        cost: dict[str, float] = defaultdict(float)
        for name in names:
            cost[file_of(name)] += self.seconds[name]
        return sorted(names, key=lambda name: (cost[file_of(name)], file_of(name), self.seconds[name]))


def file_of(test: str) -> str:
    return test.partition("::")[0]


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
    assigned = getattr(place.statement, "targets", [getattr(place.statement, "target", None)])
    return {
        part.id for target in assigned if target for part in ast.walk(target) if isinstance(part, ast.Name)
    }


def stale(mutant: Mutant) -> set[str]:
    """Files whose kernels must be compiled anew, because they hold or call the changed code."""
    names = _names(mutant)
    if not names:
        return set()
    return {mutant.file} | callers(names)[1]


def measured_reach(room: str, tests: list[str]) -> dict:
    """Run the tests of a room once; which lines each reaches, and the processor time it takes [s]."""
    with tempfile.TemporaryDirectory() as name:
        answer = Path(name) / "reach.json"
        code = in_fresh_process(lambda: _measure(tests, answer))
        if code != 0:
            sys.exit(f"the tests of {room} must pass without any change: code {code}")
        return json.loads(answer.read_text())


def _measure(tests: list[str], answer: Path) -> int:
    import coverage

    measurement = coverage.Coverage(data_file=None, source=[str(ROOT / "reliab")], config_file=False)
    recorder = Recorder(measurement)
    measurement.start()
    code = pytest.main([*OPTIONS, *tests], plugins=[recorder])
    measurement.stop()
    data = measurement.get_data()
    reached = {
        str(Path(file).relative_to(ROOT)): data.contexts_by_lineno(file) for file in data.measured_files()
    }
    record = {"seconds": recorder.seconds, "fixtures": recorder.fixtures, "lines": reached}
    answer.write_text(json.dumps(record))
    return int(code)


def judge(mutant: Mutant, names: list[str], seconds: float) -> str:
    """Run tests on a change, imported anew, and say what came of it, as `outcome`."""
    if not names:
        return "unreached"
    return outcome(in_fresh_process(lambda: _try(mutant, names), seconds))


def outcome(code: int) -> str:
    """What the end of a process says: endless used up its processor time, stuck waited or lacked memory."""
    ends = {0: "survived", -signal.SIGXCPU: "endless", -signal.SIGKILL: "stuck"}
    return ends.get(code, "killed")


def _try(mutant: Mutant, names: list[str]) -> int:
    sys.meta_path.insert(0, _Changed(mutant))
    _forget_kernels({str(ROOT / file) for file in stale(mutant)})
    importlib.import_module(module_of(mutant.file))
    files = list(dict.fromkeys(map(file_of, names)))
    return int(pytest.main([*OPTIONS, "-x", *files], plugins=[Chosen(names)]))


def module_of(file: str) -> str:
    return ".".join(Path(file).with_suffix("").parts).removesuffix(".__init__")


def _forget_kernels(sources: set[str]) -> None:
    """Compile the kernels of some files anew, and keep none of them on disk."""
    from numba.core.caching import Cache

    load, save = Cache.load_overload, Cache.save_overload

    def loaded(cache, *arguments):
        return None if cache._source_path in sources else load(cache, *arguments)  # noqa: SLF001

    def saved(cache, *arguments):
        return None if cache._source_path in sources else save(cache, *arguments)  # noqa: SLF001

    Cache.load_overload, Cache.save_overload = loaded, saved


class _Changed(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports the changed module; what is on disk stays as it is."""

    def __init__(self, mutant: Mutant) -> None:
        self.name, self.path, self.tree = module_of(mutant.file), ROOT / mutant.file, mutated(mutant)

    def find_spec(self, fullname, path=None, target=None):  # noqa: ARG002 - importlib prescribes them
        if fullname != self.name:
            return None
        return importlib.util.spec_from_file_location(fullname, self.path, loader=self)

    def create_module(self, spec):  # noqa: ARG002 - importlib prescribes it
        return None

    def exec_module(self, module):
        exec(compile(self.tree, str(self.path), "exec"), module.__dict__)  # noqa: S102 - our own source


def in_fresh_process(work: Callable[[], int], seconds: float | None = None) -> int:
    """Do work in a copy of this process, where large libraries are loaded, and return its code.

    The limit is processor time, which the kernel counts: neither load nor a pause ends the work.
    """
    for name in _HEAVY:
        importlib.import_module(name)
    gc.freeze()
    child = os.fork()
    if child == 0:
        os.setsid()
        if seconds is not None:
            limit = resource.getrlimit(resource.RLIMIT_CPU)[1]
            resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(seconds), limit))
        sys.stdout.flush()
        silence = os.open(os.devnull if not os.environ.get("MUTANTS_SHOW") else "/dev/stderr", os.O_WRONLY)
        os.dup2(silence, 1)
        os.dup2(silence, 2)
        code = 9
        try:
            code = work()
        except BaseException:  # noqa: BLE001 - the copy must not go on as its parent
            traceback.print_exc()
        finally:
            os._exit(code)
    end = time.monotonic() + (math.inf if seconds is None else _LONGEST_WAIT)
    while time.monotonic() < end:
        finished, status = os.waitpid(child, os.WNOHANG)
        if finished:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.02)
    os.killpg(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
