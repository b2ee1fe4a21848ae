"""The one place where numerical kernels are compiled, so that every kernel has the same flags."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numpy.typing import NDArray

_Kernel = TypeVar("_Kernel", bound=Callable[..., object])

# Reordering and fused multiply-add are allowed; NaN and infinity keep their meaning, because an
# unstable loop overflows and must be seen to.
_FAST = frozenset({"contract", "reassoc", "nsz", "arcp"})


def _compiled(function: _Kernel, *, cache: bool) -> _Kernel:
    compile_kernel = numba.njit(cache=cache, nogil=True, error_model="numpy", fastmath=set(_FAST))
    return cast("_Kernel", compile_kernel(function))


def compiled(function: _Kernel) -> _Kernel:
    """Compile a numerical kernel with Numba, free of the interpreter lock, and cached where a disk allows it.

    Parameters
    ----------
    function : callable
        A function of arrays and numbers in Numba's nopython subset.

    Returns
    -------
    callable
        The compiled function, with the signature of the original.
    """
    try:
        return _compiled(function, cache=True)
    except RuntimeError:  # no folder for compiled kernels can be written: each process compiles them anew
        return _compiled(function, cache=False)


@compiled
def copy_rows(source: NDArray[Any], target: NDArray[Any]) -> None:
    """Copy a table. Compilers take seconds for an assignment to a slice, and nothing for a loop.

    Parameters
    ----------
    source, target : numpy.ndarray
        Shape (rows, columns); the source may have more columns.
    """
    for row in range(target.shape[0]):
        for column in range(target.shape[1]):
            target[row, column] = source[row, column]
