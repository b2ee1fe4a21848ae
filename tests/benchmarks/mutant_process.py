"""Work done in copies of a process, with a limit of processor time."""

import gc
import importlib
import math
import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable

_HEAVY = (
    *("numpy", "scipy.stats", "scipy.optimize", "scipy.signal", "scipy.integrate", "pandas", "xarray"),
    *("numba", "hypothesis", "h5py", "h5netcdf", "typst", "emcee", "pydantic", "rich", "typer"),
    *("seaborn", "zarr", "numcodecs", "hypothesis.extra.numpy"),
)
_LONGEST_WAIT = 3600.0  # s on the clock for a change whose tests wait without working


def outcome(code: int) -> str:
    """What the end of a process says: endless used up its processor time, stuck waited or lacked memory."""
    ends = {0: "survived", -signal.SIGXCPU: "endless", -signal.SIGKILL: "stuck"}
    return ends.get(code, "killed")


def run_in_copy(work: Callable[[], int], seconds: float | None = None) -> int:
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
        ended_child, status = os.waitpid(child, os.WNOHANG)
        if ended_child:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.02)
    os.killpg(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
