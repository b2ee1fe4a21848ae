"""Kernels are compiled also where no folder can be written."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from reliab.core.compiled import copy_rows

COMPILERS = {"njit", "jit", "cfunc", "vectorize", "guvectorize"}
PACKAGE = Path(__file__).resolve().parents[2] / "reliab"


KERNEL = """
from reliab.core.compiled import compiled
@compiled
def half(x):
    return x / 2
print(half(3.0))
"""
CALLED_BY_ADDRESS = """
from numba import types
from reliab.core.compiled import compile_callback
def half(x):
    return x / 2
print(compile_callback(types.float64(types.float64), half).ctypes(3.0))
"""


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize("source", [KERNEL, CALLED_BY_ADDRESS])
def test_kernels_need_no_folder_for_their_cache(tmp_path, source):
    (tmp_path / "kernel.py").write_text(source)
    (tmp_path / "__pycache__").touch()
    nowhere = {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null", "NUMBA_CACHE_DIR": ""}
    process = subprocess.run(  # noqa: S603 - this very package
        [sys.executable, "-B", str(tmp_path / "kernel.py")],
        env={**os.environ, **nowhere, "PYTHONPATH": str(Path(__file__).resolve().parents[2])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert process.stdout == "1.5\n", process.stderr
    assert process.stderr.count("Compiled code cannot be kept") == 1


@pytest.mark.slow
def test_numba_is_told_to_compile_in_one_place_only():
    elsewhere = {
        str(path.relative_to(PACKAGE))
        for path in PACKAGE.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_bytes()))
        if getattr(node, "attr", getattr(node, "name", ""))
        in {"njit", "jit", "cfunc", "vectorize", "guvectorize"}
    }
    assert elsewhere == {"core/compiled.py"}


READ_ALL_THAT_IS_KEPT = """
import sys
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages

import reliab
from numba.core.dispatcher import Dispatcher

for module in walk_packages(reliab.__path__, "reliab."):
    if not module.name.endswith("__main__"):
        import_module(module.name)
kernels = {
    id(value): value
    for name, module in list(sys.modules.items())
    for value in vars(module).values()
    if name.startswith("reliab") and isinstance(value, Dispatcher) and value._cache
}

def kept(kernel):  # types of arguments, and whether the code itself names what it imports of Numba
    files = kernel._cache._cache_file
    for (types, *_), name in files._load_index().items():
        path = Path(files._cache_path, name)
        if path.exists():
            yield b"numba.np." in path.read_bytes(), types


waiting = [(names, types, kernel) for kernel in kernels.values() for names, types in kept(kernel)]
read = 0
for names, types, kernel in sorted(waiting, key=lambda item: item[0]):
    compiler = "numba.np.npyimpl" in sys.modules
    code = kernel._cache.load_overload(types, kernel.targetctx)
    if code is not None:  # compiled for another processor
        assert code.library.get_pointer_to_function(code.fndesc.llvm_cpython_wrapper_name)
        read += not compiler
print(read)
"""


@pytest.mark.slow
def test_every_kept_kernel_is_read_without_the_compiler():
    """A function that machine code needs and that is nowhere ends the process.

    Those that name modules of Numba, which they import, come last.
    """
    copy_rows(np.zeros((2, 2)), np.zeros((2, 2)))  # one at least; other tests compile the others
    for _ in range(2):  # what is called by its address is compiled when it is imported first
        process = subprocess.run(  # noqa: S603 - this very package
            [sys.executable, "-c", READ_ALL_THAT_IS_KEPT], capture_output=True, text=True, check=False
        )
        assert process.returncode == 0, process.stderr
    assert int(process.stdout.split()[-1]) >= 1, process.stdout


SUM = """
from reliab.core.compiled import compiled
@compiled
def total(pair):
    return pair.x + pair.y
"""
PAIR = """
from typing import NamedTuple
class Pair(NamedTuple):
    x: float
    y: float
"""


@pytest.mark.slow
def test_compiled_code_of_another_version_is_forgotten(tmp_path):
    """The type of an argument has moved, as it may between two versions of the package."""
    (tmp_path / "total.py").write_text(SUM)
    for module in ("before", "after"):
        (tmp_path / f"{module}.py").write_text(PAIR)
        statement = f"from total import total; from {module} import Pair; print(total(Pair(1.0, 2.0)))"
        run = subprocess.run(  # noqa: S603 - this very package
            [sys.executable, "-c", statement], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert run.stdout == "3.0\n", run.stderr
        assert list((tmp_path / "__pycache__").glob("total.total*.nbi"))
        (tmp_path / f"{module}.py").unlink()
