"""Simulations per second and core: the engines beside a plain Runge-Kutta loop, JiTCDDE and ddeint.

The baseline integrates the delay equation at 1024 Hz with fourth-order Runge-Kutta and linear history,
compiled with Numba, one cell at a time, and keeps the two errors. All are run on one thread, the paper's
grid (41 gains, 21 delays) before a 1 Hz structure with 2 % damping, under one record.

    python tests/benchmarks/engines.py [RECORD]
"""

import sys
import time
from collections.abc import Callable

import numba
import numpy as np
from numpy.typing import NDArray

from reliab.loop import delay_stepper, pole_stepping
from reliab.loop.blocks import cut
from reliab.loop.excitation import Excitation
from reliab.loop.structure import Structure
from reliab.motions import Motion, load_motions, resample
from reliab.sweep import ExplicitGrid

RATE_HZ = 1024.0
REPETITIONS = 7


@numba.njit(fastmath=True)
def past(x: NDArray[np.float64], i: int, place: float) -> float:
    """Displacement between samples, the last of which is i."""
    if place < 0.0:
        return 0.0
    k = min(int(place), i)
    return x[k] + (x[min(k + 1, i)] - x[k]) * (place - k)


@numba.njit(fastmath=True)
def runge_kutta(
    record: NDArray[np.float64],
    ideal: NDArray[np.float64],
    h: float,
    w0: float,
    xi: float,
    gain: float,
    delay: float,
) -> tuple[float, float]:
    """Sum of squares and largest of x_m - x_I of one cell."""
    n, late = record.size, delay / h
    x = np.zeros(n)
    v, squares, peak = 0.0, 0.0, 0.0
    stiffness, damping = gain * w0 * w0, 2.0 * xi * w0
    for i in range(n - 1):
        first, middle, last = past(x, i, i - late), past(x, i, i + 0.5 - late), past(x, i, i + 1.0 - late)
        f0, f2 = -record[i], -record[i + 1]
        f1 = 0.5 * (f0 + f2)
        k1x, k1v = v, f0 - damping * v - stiffness * first
        k2x = v + 0.5 * h * k1v
        k2v = f1 - damping * k2x - stiffness * middle
        k3x = v + 0.5 * h * k2v
        k3v = f1 - damping * k3x - stiffness * middle
        k4x = v + h * k3v
        k4v = f2 - damping * k4x - stiffness * last
        x[i + 1] = x[i] + h / 6.0 * (k1x + 2.0 * k2x + 2.0 * k3x + k4x)
        v += h / 6.0 * (k1v + 2.0 * k2v + 2.0 * k3v + k4v)
        strayed = gain * first - ideal[i]
        squares += strayed * strayed
        peak = max(peak, abs(strayed))
    return squares, peak


def best(work: Callable[[], object]) -> float:
    """Shortest of several times [s]; the first run, which compiles, is not counted."""
    work()
    times = []
    for _ in range(REPETITIONS):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def baseline(motion: Motion, structure: Structure) -> float:
    """Simulations per second of the baseline."""
    fine = resample(motion, RATE_HZ)
    ideal = np.zeros(fine.acceleration.size)
    w0, xi, h = structure.circular_frequency, structure.damping_ratio, fine.time_step

    def work() -> None:
        for _ in range(20):
            runge_kutta(fine.acceleration, ideal, h, w0, xi, 1.0, 0.001)

    return 20.0 / best(work)


def jitcdde_rate(motion: Motion, structure: Structure) -> float | None:
    """Simulations per second of JiTCDDE under a harmonic of the record's length; None where not installed."""
    try:
        from jitcdde import jitcdde, t, y
        from symengine import sin
    except ImportError:
        return None
    w0, xi, delay = structure.circular_frequency, structure.damping_ratio, 0.001
    solver = jitcdde([y(1), -sin(w0 * t) - 2 * xi * w0 * y(1) - w0**2 * y(0, t - delay)], max_delay=delay)
    solver.constant_past([0.0, 0.0])
    solver.compile_C()
    solver.integrate_blindly(0.01, 0.001)
    start = time.perf_counter()
    for instant in np.arange(solver.t, motion.duration, 0.01):
        solver.integrate(instant)
    return 1.0 / (time.perf_counter() - start)


def ddeint_rate(motion: Motion, structure: Structure) -> float | None:
    """Simulations per second of ddeint, from its first two seconds; None where it is not installed."""
    try:
        from ddeint import ddeint
    except ImportError:
        return None
    w0, xi, delay = structure.circular_frequency, structure.damping_ratio, 0.001

    def model(state: Callable[[float], NDArray[np.float64]], instant: float) -> NDArray[np.float64]:
        v = state(instant)[1]
        ground = np.interp(instant, motion.times, motion.acceleration)
        return np.array([v, -ground - 2 * xi * w0 * v - w0**2 * state(instant - delay)[0]])

    instants = np.arange(0.0, 2.0, 1.0 / RATE_HZ)
    start = time.perf_counter()
    ddeint(model, lambda _: np.zeros(2), instants)
    return 2.0 / motion.duration / (time.perf_counter() - start)


def main() -> None:
    motion = load_motions(*(sys.argv[1:] or ["synthetic"]))[0]
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    cells = ExplicitGrid().cells(structure)
    blocks = cut(excitation, structure)
    (recursion,) = cells.recursions(blocks.step)

    def pole() -> object:
        prepared = cut(excitation, structure)
        return pole_stepping.deviation(prepared, recursion.coefficients)

    def delayed() -> object:
        return delay_stepper.deviation(blocks, structure, cells.gain, cells.delay)

    reference = baseline(motion, structure)
    rates = {
        "Runge-Kutta at 1024 Hz (baseline)": reference,
        "delay engine": cells.gain.size / best(delayed),
        "pole engine": cells.gain.size / best(pole),
        "JiTCDDE": jitcdde_rate(motion, structure),
        "ddeint": ddeint_rate(motion, structure),
    }
    print(f"{motion.name}: {motion.duration:.1f} s at {motion.time_step:g} s, {cells.gain.size} cells")
    for name, rate in rates.items():
        shown = "not installed" if rate is None else f"{rate:14.4g} /s {rate / reference:12.3g} x baseline"
        print(f"{name:36s} {shown}")


if __name__ == "__main__":
    main()
