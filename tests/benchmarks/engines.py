"""Simulations per second and core: the engines beside a plain Runge-Kutta loop and JiTCDDE.

The baseline integrates the delay equation at 1024 Hz with fourth-order Runge-Kutta and linear history,
compiled with Numba, one cell at a time, and keeps the two errors. All are run on one thread, the paper's
grid (41 gains, 21 delays) before a 1 Hz structure with 2 % damping, under one record.

    python -m pip install ".[benchmark]"
    python tests/benchmarks/engines.py [RECORD]
"""

import contextlib
import platform
import sys
import tempfile
import time
from pathlib import Path

import numba
import numpy as np
import threadpoolctl
from benchmark_script import shortest_time
from numpy.typing import NDArray

from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion, resample
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import delay_stepper
from reliab.simulation.linear_loop.blocks import block_length, cut
from reliab.simulation.linear_loop.pole_plane import mean_squares
from reliab.structures.structure import Structure
from reliab.sweep.request import ExplicitGrid

RATE_HZ = 1024.0
REPETITIONS = 15


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
        error = gain * first - ideal[i]
        squares += error * error
        peak = max(peak, abs(error))
    return squares, peak


def baseline(motion: Motion, structure: Structure) -> float:
    """Simulations per second of the baseline."""
    fine = resample(motion, RATE_HZ)
    ideal = np.zeros(fine.acceleration.size)
    w0, xi, h = structure.circular_frequency, structure.damping_ratio, fine.time_step

    def work() -> None:
        for _ in range(20):
            runge_kutta(fine.acceleration, ideal, h, w0, xi, 1.0, 0.001)

    return 20.0 / shortest_time(work, REPETITIONS)[1]


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
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):  # its build reads pyproject.toml
        solver.compile_C()
    solver.integrate_blindly(0.01, 0.001)
    start = time.process_time()
    for instant in np.arange(solver.t + 0.01, motion.duration, 0.01):
        solver.integrate(instant)
    return 1.0 / (time.process_time() - start)


def plane_rates(motion: Motion, structure: Structure) -> tuple[float, float]:
    """Simulations per second of RMS^R alone by the responses of a few poles, for late actuators.

    The first counts the responses of the poles, the second is that of further actuators under the same
    motion. As for the pole engine, what depends on the actuators alone is prepared before.
    """
    cells = ExplicitGrid().cells(structure)
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    expansions, first = cells.expansions(block_length(structure)), np.zeros(cells.gain.size, dtype=np.int64)

    def anew() -> None:
        responses = Loop(excitation=excitation, structure=structure).responses
        mean_squares([responses], expansions, first)

    responses = Loop(excitation=excitation, structure=structure).responses

    def solve_again() -> None:
        mean_squares([responses], expansions, first)

    anew_seconds, again_seconds = (shortest_time(work, REPETITIONS)[1] for work in (anew, solve_again))
    return cells.gain.size / anew_seconds, cells.gain.size / again_seconds


def machine() -> str:
    """Name of the processor."""
    with contextlib.suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def main() -> None:
    motion = load_motions(*(sys.argv[1:] or ["synthetic"]))[0]
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    cells = ExplicitGrid().cells(structure)
    blocks = cut(excitation, structure)

    def pole() -> object:
        return Loop(excitation=excitation, structure=structure, engine=Engine.POLE).deviation(cells)

    def step_delay() -> object:
        return delay_stepper.deviation(blocks, structure, cells.gain, cells.delay)

    threadpoolctl.threadpool_limits(1)
    reference, plane = baseline(motion, structure), plane_rates(motion, structure)
    rates = {
        "Runge-Kutta at 1024 Hz (baseline)": reference,
        "delay engine": cells.gain.size / shortest_time(step_delay, REPETITIONS)[1],
        "pole engine": cells.gain.size / shortest_time(pole, REPETITIONS)[1],
        "pole plane, RMS^R only": plane[0],
        "the same, further actuators": plane[1],
        "JiTCDDE": jitcdde_rate(motion, structure),
    }
    print(machine())
    print(f"{motion.name}: {motion.duration:.1f} s at {motion.time_step:g} s, {cells.gain.size} cells")
    for name, rate in rates.items():
        text = "not installed" if rate is None else f"{rate:14.4g} /s {rate / reference:12.3g} x baseline"
        print(f"{name:36s} {text}")
    steps = rates["pole engine"] * blocks.left.size
    print(f"pole engine: {steps:.3g} system-steps/s of {1e3 * blocks.step:g} ms")


if __name__ == "__main__":
    main()
