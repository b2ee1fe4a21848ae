"""The monitor in C, exported, compiled and run from Python."""

import ctypes
import shutil
import subprocess
from dataclasses import dataclass

import numpy as np
import pytest

from reliab.in_loop.sources import monitor_sources

STRICT = ("-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
needs_compiler = pytest.mark.skipif(not COMPILERS, reason="no C compiler is installed here")
SHIM = """
#include "reliab_monitor.h"
#include <stddef.h>
#define P RELIAB_ACTUATORS
size_t follow_size(void);
void follow(void *place, const double *begin, long n, const double *command, const double *measured,
            double *out);
size_t follow_size(void) { return sizeof(reliab_monitor); }
void follow(void *place, const double *begin, long n, const double *command, const double *measured,
            double *out)
{
    reliab_monitor *monitor = (reliab_monitor *)place;
    long i;
    unsigned k;
    reliab_monitor_init(monitor);
    if (begin != NULL) { reliab_monitor_begin(monitor, begin, begin + P); }
    for (i = 0; i < n; i++) {
        double *row = out + (3u * P + 4u) * i;
        row[3u * P] = reliab_monitor_step(monitor, command + P * i, measured + P * i);
        for (k = 0u; k < P; k++) {
            row[k] = reliab_monitor_error(monitor, k);
            row[P + k] = reliab_monitor_rms(monitor, k);
            row[2u * P + k] = reliab_monitor_mte(monitor, k);
        }
        row[3u * P + 1u] = reliab_monitor_net_damping(monitor);
        row[3u * P + 2u] = reliab_monitor_governing(monitor);
        row[3u * P + 3u] = monitor->sensors[0].offset;
    }
}
"""
UNSTABLE, ERROR, FAULT = 1, 2, 4


@dataclass(frozen=True)
class MonitorOutput:
    """What the monitor said after each sample; error, rms and mte of several actuators in rows."""

    error: np.ndarray
    rms: np.ndarray
    mte: np.ndarray
    status: np.ndarray
    damping: np.ndarray
    governing: np.ndarray
    offset: np.ndarray


def build(folder, compiler=None, flags=STRICT):
    """The exported folder as a library."""
    (folder / "shim.c").write_text(SHIM)
    library = folder / f"monitor{len(list(folder.glob('*.so')))}.so"
    compile_with = [compiler or COMPILERS[0], *flags, "-fPIC", "-c", "reliab_monitor.c", "shim.c"]
    # linked without the flags: with -ffast-math some linkers add code that rounds the denormal numbers of
    # the whole process to zero, and with them those of all tests that follow
    link = [compiler or COMPILERS[0], "-shared", "reliab_monitor.o", "shim.o", "-lm", "-o", str(library)]
    for command in (compile_with, link):
        subprocess.run(command, cwd=folder, check=True)  # noqa: S603 - a compiler
    return ctypes.CDLL(str(library))


def build_monitor(monitor, folder, compiler=None):
    """The library of a monitor."""
    folder.mkdir(exist_ok=True)
    for name, text in monitor_sources(monitor).items():
        (folder / name).write_text(text, encoding="utf-8")
    return build(folder, compiler)


def follow(library, command, reading, begin=None):
    """Follow a test; histories of several actuators in rows, `begin`: offsets, then standing differences."""
    actuators = 1 if command.ndim == 1 else command.shape[0]
    size = command.shape[-1]
    table = np.empty((size, 3 * actuators + 4))
    library.follow_size.restype = ctypes.c_size_t
    place = ctypes.create_string_buffer(library.follow_size() + 16)
    channels = [np.ascontiguousarray(values.T, dtype=np.float64) for values in (command, reading)]
    pointers = [values.ctypes.data_as(ctypes.c_void_p) for values in (*channels, table)]
    state = None if begin is None else (ctypes.c_double * len(begin))(*begin)
    library.follow(place, state, ctypes.c_long(size), *pointers)
    parts = np.split(table.T, [actuators, 2 * actuators, 3 * actuators])
    degree_errors = [part[0] if command.ndim == 1 else part for part in parts[:3]]
    return MonitorOutput(*degree_errors, *parts[3])


def compare(folder, samples, compiler=None):
    """Whether C gives the errors of a drawn test, and its alarm at the same sample; return what it says."""
    ours = follow(
        build_monitor(samples.monitor, folder, compiler), samples.command, samples.measured, samples.begin
    )
    assert_same(ours.error, samples)
    if len(samples.error) == 1:
        error = np.flatnonzero(ours.status.astype(int) & UNSTABLE)
        assert (error[0] * samples.monitor.time_step if error.size else None) == pytest.approx(samples.alarm)
    offset = samples.begin[: len(samples.command), np.newaxis]
    carry = samples.monitor.coefficients.carry
    ideal = np.abs(carry @ (samples.measured - offset) - samples.error).max(axis=1)
    square = samples.error**2
    mean = (square.sum(axis=1) - 0.5 * (square[:, 0] + square[:, -1])) / (square.shape[1] - 1)
    assert ours.rms[:, -1] == pytest.approx(np.sqrt(mean) / ideal, rel=1e-9)
    assert ours.mte[:, -1] == pytest.approx(np.abs(samples.error).max(axis=1) / ideal, rel=1e-9)
    return ours


def assert_same(error, samples):
    """Whether errors are those of Python, to 1e-12 of the peak."""
    assert (np.abs(error - samples.error) < 1e-12 * samples.peaks[:, np.newaxis]).all()
