"""One thread for linear algebra, whose matrices are small here."""

import importlib
import os
from contextlib import AbstractContextManager, nullcontext
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

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


@cache
def _libraries() -> "ThreadpoolController":
    """Libraries that are loaded; looking for them takes longer than a small product."""
    from threadpoolctl import ThreadpoolController

    importlib.import_module("scipy.linalg")  # SciPy has a library of its own, which it loads late
    return ThreadpoolController()
