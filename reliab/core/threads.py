"""Threads: one for linear algebra, whose matrices are small here, and two for draws, which are many."""

import importlib
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

_Answer = TypeVar("_Answer")
_FEWEST_SHARED = 32  # draws: on a busy computer a thread for fewer is waited for longer than they take


ONE_THREAD = dict.fromkeys(
    (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "BLIS_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
    ),
    "1",
)
"""Environment in which libraries of linear algebra have one thread, as the command line loads them.

Sums differ in the last digit with the number of threads.
"""


def one_thread() -> AbstractContextManager[Any]:
    """Let the libraries of linear algebra use one thread inside, where they were not loaded with one.

    >>> import numpy as np
    >>> with one_thread():
    ...     print(np.eye(2) @ np.ones(2))
    [1. 1.]
    """
    if os.environ.items() >= ONE_THREAD.items():
        return nullcontext()
    limits: AbstractContextManager[Any] = _libraries().limit(limits=1, user_api="blas")
    return limits


def run_in_two_shares(draws: int, sweep: Callable[[slice], _Answer]) -> list[_Answer]:
    """Sweep two shares of draws at once, on any computer, by a kernel that needs no interpreter; few as one.

    >>> run_in_two_shares(65, lambda share: (share.start, share.stop))
    [(0, 32), (32, 65)]
    >>> run_in_two_shares(7, lambda share: share.stop)
    [7]
    """
    if draws < _FEWEST_SHARED:
        return [sweep(slice(0, draws))]
    half = draws // 2
    with ThreadPoolExecutor(1) as pool:
        second = pool.submit(sweep, slice(half, draws))
        return [sweep(slice(0, half)), second.result()]


@cache
def _libraries() -> "ThreadpoolController":
    """Libraries that are loaded; looking for them takes longer than a small product."""
    from threadpoolctl import ThreadpoolController

    importlib.import_module("scipy.linalg")  # SciPy has a library of its own, which it loads late
    return ThreadpoolController()
