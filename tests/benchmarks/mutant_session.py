"""Many changes tried in copies of one process that has collected the tests of a room.

A change within a function replaces the function's code in the copy, so that nothing is imported or collected
again; where the function is compiled, the copy compiles it anew, and whatever calls it.
"""

import gc
import importlib
import sys
from collections import defaultdict
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import CodeType, FunctionType

import pytest
from benchmarks.mutant_places import ROOT, Mutant, home, mutate
from benchmarks.mutant_process import run_in_copy
from benchmarks.mutant_tests import OPTIONS, TestSelection, forget_kernels, judge_run, module_of, stale
from numba.core.dispatcher import Dispatcher

from reliab.effects.kernel import Kernel

Work = tuple[Mutant, list[str], float]
"""A change, the names of the tests that try it, and the processor time that they may take [s]."""


def judge_together(tests: list[str], work: list[Work], note: Callable[[Mutant, str], None]) -> None:
    """Try changes in one session of the tests; note the outcome of those whose code can be replaced."""
    run_in_copy(lambda: int(pytest.main([*OPTIONS, *tests], plugins=[_Session(work, note)])))


class _Session:
    """Plugin that tries changes instead of running the tests once."""

    def __init__(self, work: list[Work], note: Callable[[Mutant, str], None]) -> None:
        self.work, self.note = work, note
        self.compiled: list[Dispatcher | Kernel] = []

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session):
        for mutant, _, _ in self.work:
            importlib.import_module(module_of(mutant.file))
        functions, self.compiled = _functions(), _list_kernels()
        for mutant, names, seconds in self.work:
            code = _mutate_code(mutant)
            targets = functions.get(_key(code), []) if code is not None and names else []
            if targets:
                run = partial(_run, session, targets, code, self._stale(mutant))
                self.note(mutant, judge_run(names, run, seconds))
        return True

    def _stale(self, mutant: Mutant) -> tuple[set[str], list[Dispatcher | Kernel]]:
        """Files whose kernels a change reaches, and what was compiled from them."""
        sources = {str(ROOT / file) for file in stale(mutant)}
        return sources, [thing for thing in self.compiled if _source(thing) in sources]


def _functions() -> dict[tuple[str, int, str], list[FunctionType]]:
    """Functions of the package that are alive, by what names their code."""
    functions = defaultdict(list)
    for thing in gc.get_objects():
        if isinstance(thing, FunctionType) and thing.__code__.co_filename.startswith(str(ROOT / "reliab")):
            functions[_key(thing.__code__)].append(thing)
    return functions


def _list_kernels() -> list[Dispatcher | Kernel]:
    """Compiled functions that are alive; a copy of the process no longer lists what was there before it."""
    return [thing for thing in gc.get_objects() if isinstance(thing, Dispatcher | Kernel)]


def _source(thing: Dispatcher | Kernel) -> str:
    function = thing.function if isinstance(thing, Kernel) else thing.py_func
    return str(function.__code__.co_filename)


def _key(code: CodeType) -> tuple[str, int, str]:
    return code.co_filename, code.co_firstlineno, code.co_qualname


def _mutate_code(mutant: Mutant) -> CodeType | None:
    """Code of the changed function; None where the change is outside functions."""
    place = home(mutant)
    if not place.is_in_body:
        return None
    first = min([place.function.lineno, *(mark.lineno for mark in place.function.decorator_list)])
    waiting = [compile(mutate(mutant), str(ROOT / mutant.file), "exec")]
    while waiting:
        code = waiting.pop()
        if code.co_name == place.function.name and code.co_firstlineno == first:
            return code
        waiting += [part for part in code.co_consts if isinstance(part, CodeType)]
    return None


def _run(
    session: pytest.Session,
    targets: list[FunctionType],
    code: CodeType,
    kernels_to_compile: tuple[set[str], list[Dispatcher | Kernel]],
    names: list[str],
    note: Path,
    *,
    is_changed: bool,
) -> int:
    """Run tests until the first fails, with changed code; kernels of some sources are compiled anew."""
    if is_changed:
        for function in targets:
            function.__code__ = code
        _compile_anew(*kernels_to_compile)
    items = list(session.items)
    TestSelection(names).pytest_collection_modifyitems(items)
    for item, following in zip(items, [*items[1:], None], strict=True):
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
        if session.testsfailed:
            note.write_text(item.nodeid)
            return 1
    sys.stdout.flush()
    return 0


def _compile_anew(sources: set[str], dispatchers: list[Dispatcher | Kernel]) -> None:
    """Forget what was compiled from some files, in memory and on disk."""
    if not sources:
        return
    forget_kernels(sources)
    for thing in dispatchers:
        if isinstance(thing, Kernel):
            vars(thing).pop("_compiled", None)
        else:
            getattr(thing, "_reset_overloads")()  # noqa: B009 - Numba has no other way, and states no type
