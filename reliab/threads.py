"""One thread for linear algebra: for matrices as small as ours several cost more time than they save."""

import importlib
from contextlib import AbstractContextManager
from functools import cache
from typing import Any

from threadpoolctl import ThreadpoolController


def one_thread() -> AbstractContextManager[Any]:
    """Let the libraries of linear algebra use one thread inside.

    >>> import numpy as np
    >>> with one_thread():
    ...     print(np.eye(2) @ np.ones(2))
    [1. 1.]
    """
    limits: AbstractContextManager[Any] = _libraries().limit(limits=1, user_api="blas")
    return limits


@cache
def _libraries() -> ThreadpoolController:
    """Libraries that are loaded; looking for them takes longer than a small product."""
    importlib.import_module("scipy.linalg")  # SciPy has a library of its own, which it loads late
    return ThreadpoolController()
