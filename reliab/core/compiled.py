"""The one place where numerical kernels are compiled, so that every kernel has the same flags.

Before it reads a compiled kernel, Numba imports all that it can compile: 200 modules, a tenth of a second.
Machine code needs its runtime alone. That is an inner matter of Numba, and what lacked would end the process:
kernels of this package are read so with the versions of Numba with which that is tested.
"""

import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Final, TypeVar, cast

import numba
from numba.core.caching import FunctionCache
from numba.core.ccallback import CFunc
from numba.core.runtime.nrt import rtsys
from numba.core.sigutils import normalize_signature
from numpy.typing import NDArray

_Kernel = TypeVar("_Kernel", bound=Callable[..., object])

# Reordering and fused multiply-add are allowed; NaN and infinity keep their meaning, because an
# unstable loop overflows and must be seen to.
_FAST = frozenset({"contract", "reassoc", "nsz", "arcp"})

_NEWEST_TESTED: Final = (0, 68)
_IS_TESTED_NUMBA: Final = tuple(map(int, numba.__version__.split(".")[:2])) <= _NEWEST_TESTED


class _Runtime:
    """A target of Numba as far as machine code needs it."""

    def __init__(self, target: Any) -> None:  # noqa: ANN401 - Numba states no type
        self._target = target

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        return getattr(self._target, name)

    def refresh(self) -> None:
        """Start the runtime alone; before it compiles, Numba imports its compiler once more."""
        rtsys.initialize(self._target)


class _DiskCache(FunctionCache):
    """Compiled code of a kernel on the disk, which is forgotten if it is of another version."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:  # noqa: ANN401
        """Read the code for types of arguments; None where there is none."""
        try:
            return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except (ImportError, AttributeError):  # a kernel that it called has moved
            self.flush()  # type: ignore[no-untyped-call]
            return None


class _MachineCode(_DiskCache):
    """Compiled code of a kernel on the disk, which is read without the compiler."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:  # noqa: ANN401
        """Read the code for types of arguments; None where there is none."""
        return super().load_overload(sig, _Runtime(target_context))


def _disk_cache(function: Callable[..., object]) -> Any:  # noqa: ANN401
    """Where the code of a kernel is kept; raises RuntimeError where no folder can be written."""
    is_own = function.__module__.partition(".")[0] == __name__.partition(".")[0]
    return (_MachineCode if is_own and _IS_TESTED_NUMBA else _DiskCache)(function)  # type: ignore[no-untyped-call]


def compiled(function: _Kernel) -> _Kernel:
    """Compile a numerical kernel with Numba, free of the interpreter lock, cached where a disk allows it."""
    kernel: Any = numba.njit(nogil=True, error_model="numpy", fastmath=set(_FAST))(function)
    return cast("_Kernel", _attach_cache(kernel, function))


def compile_callback(signature: object, function: Callable[..., float]) -> Any:  # noqa: ANN401 - Numba states no type
    """Compile a function that other kernels call by its address, cached where a disk allows it."""
    signature_types, options = normalize_signature(signature), {"nopython": True, "error_model": "numpy"}  # type: ignore[no-untyped-call]
    callback = _attach_cache(CFunc(function, signature_types, {}, options), function)
    callback.compile()
    return callback


def _attach_cache(kernel: Any, function: Callable[..., object]) -> Any:  # noqa: ANN401
    """Keep what is compiled on disk, unless no folder for it can be written."""
    try:
        kernel._cache = _disk_cache(function)  # noqa: SLF001
    except RuntimeError:
        _warn_uncached()
    return kernel


@cache
def _warn_uncached() -> None:
    warnings.warn(
        "Compiled code cannot be kept, because neither the folder of reliab nor your cache folder can be "
        "written: every run compiles it anew, which takes some seconds. "
        "Set the environment variable NUMBA_CACHE_DIR to a folder that can be written.",
        stacklevel=3,
    )


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
