"""The one place where numerical kernels are compiled, so that every kernel has the same flags."""

import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numpy.typing import NDArray

_Kernel = TypeVar("_Kernel", bound=Callable[..., object])
_Compiled = TypeVar("_Compiled")
_Array = TypeVar("_Array", bound=NDArray[Any])

# Reordering and fused multiply-add are allowed; NaN and infinity keep their meaning, because an
# unstable loop overflows and must be seen to.
_FAST = frozenset({"contract", "reassoc", "nsz", "arcp"})


def _compiled(function: _Kernel, *, cache: bool) -> _Kernel:
    compile_kernel = numba.njit(cache=cache, nogil=True, error_model="numpy", fastmath=set(_FAST))
    return cast("_Kernel", compile_kernel(function))


def compiled(function: _Kernel) -> _Kernel:
    """Compile a numerical kernel with Numba, free of the interpreter lock, cached where a disk allows it."""
    return _kept_where_possible(lambda cache: _compiled(function, cache=cache))


def compiled_callback(signature: object, function: Callable[..., float]) -> Any:  # noqa: ANN401 - Numba states no type
    """Compile a function that other kernels call by its address, cached where a disk allows it."""

    def compile_callback(cache: bool) -> Any:  # noqa: ANN401, FBT001
        options = {"cache": cache, "nopython": True, "error_model": "numpy"}
        return cast("Any", numba.cfunc)(signature, **options)(function)

    return _kept_where_possible(compile_callback)


def _kept_where_possible(compile_kernel: Callable[[bool], _Compiled]) -> _Compiled:
    """Compile with a cache on disk, and without one where no folder for it can be written."""
    try:
        return compile_kernel(True)  # noqa: FBT003
    except RuntimeError:
        _say_that_none_are_kept()
        return compile_kernel(False)  # noqa: FBT003


@cache
def _say_that_none_are_kept() -> None:
    warnings.warn(
        "Compiled code cannot be kept, because neither the folder of reliab nor your cache folder can be "
        "written: every run compiles it anew, which takes some seconds. "
        "Set the environment variable NUMBA_CACHE_DIR to a folder that can be written.",
        stacklevel=3,
    )


def read_only(array: _Array) -> _Array:
    """View of an array that kernels take as one type, whether its owner may change it or not.

    >>> import numpy as np
    >>> read_only(np.zeros(3)).flags.writeable
    False
    """
    view = array.view()
    view.flags.writeable = False
    return view


@compiled
def copy_rows(source: NDArray[Any], target: NDArray[Any]) -> None:
    """Copy a table. Compilers take seconds for an assignment to a slice, and nothing for a loop."""
    for row in range(target.shape[0]):
        for column in range(target.shape[1]):
            target[row, column] = source[row, column]


def kernel_folder() -> Path | None:
    """Folder in which compiled kernels of this module are kept; None where none can be written."""
    cache = getattr(copy_rows, "stats", None)  # a plain function where Numba is told to compile nothing
    return Path(cache.cache_path) if cache and cache.cache_path else None
