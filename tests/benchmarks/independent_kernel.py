"""Another fast solver of the paper's grid, written from the equations alone, and the pole engine beside it.

The loop's dominant pole is stepped exactly at the record's own step, for an acceleration that is linear
between samples; all other poles are a constant feed-through. A step costs five multiply-adds. What does not
depend on the record is prepared before, as for the pole engine. Peaks are those of samples, without the
parabola of the pole engine, and nothing falls back to another engine.

    python tests/benchmarks/independent_kernel.py [RECORD ...]

Both are run in turns in one process, each with the paper's 861 actuators before 1 Hz, ξ = 0.02; the ratio is
the median over turns of its time over that of the pole engine, so that 1 means equal speed. Both errors are
compared with the spectral engine up to nine tenths of the critical delay.
"""

import sys
import time
from collections.abc import Callable

import numba
import numpy as np
import threadpoolctl
from numpy.typing import NDArray

from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion, resample
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure, critical_delay
from reliab.sweep.request import ExplicitGrid

Numbers = NDArray[np.float64]
LANES = 64  # cells that advance side by side
TURNS = 100


def recursion(w0: float, xi: float, gain: Numbers, delay: Numbers, h: float) -> Numbers:
    """Coefficients of x_m: of the last two samples of x_m, then of the last three of the record."""
    s = np.full(gain.shape, w0 * complex(-xi, np.sqrt(1.0 - xi**2)))
    for _ in range(30):  # Newton's method for s² + 2ξω₀s + k_p ω₀² e^(−sτ) = 0
        late = gain * w0**2 * np.exp(-s * delay)
        s -= (s * s + 2.0 * xi * w0 * s + late) / (2.0 * (s + xi * w0) - delay * late)
    late = gain * np.exp(-s * delay)
    residue = -late / (2.0 * (s + xi * w0) - delay * w0**2 * late)
    feed = 2.0 * (residue / s).real - 1.0 / w0**2
    growth = np.exp(s * h)
    ramp = ((growth - 1.0) / s - h) / (s * h)
    constant_part = (growth - 1.0) / s - ramp
    c1, c2 = 2.0 * growth.real, -(np.abs(growth) ** 2)
    new = 2.0 * (residue * ramp).real + feed
    middle = 2.0 * (residue * (constant_part - ramp * growth.conj())).real - c1 * feed
    old = -2.0 * (residue * constant_part * growth.conj()).real - c2 * feed
    return np.stack([c1, c2, new, middle, old])


@numba.njit(fastmath=True)
def step(k: tuple[float, ...], y: float, z: float, a: float, b: float, c: float) -> float:
    """Next sample of x_m after y, before which z was."""
    return k[0] * y + (k[1] * z + (k[2] * c + (k[3] * b + k[4] * a)))


@numba.njit(fastmath=True)
def larger(a: float, b: float) -> float:
    """Larger of two numbers, without a branch."""
    return b if b > a else a  # noqa: FURB136 - the built-in has branches


@numba.njit(fastmath=True)
def history(record: Numbers, k: tuple[float, ...]) -> Numbers:
    """x_m of one cell; the first two samples of the record are zeros."""
    x = np.zeros(record.size)
    for i in range(2, record.size):
        x[i] = step(k, x[i - 1], x[i - 2], record[i - 2], record[i - 1], record[i])
    return x


@numba.njit(fastmath=True)
def lanes(record: Numbers, exact: Numbers, coefficients: Numbers) -> tuple[Numbers, Numbers]:
    """Sums of squares and largest moduli of x_m − x_I of one set of cells."""
    c = np.empty((5, LANES))
    for row in range(5):
        for j in range(LANES):
            c[row, j] = coefficients[row, j]
    x, z, squares, peak = np.zeros(LANES), np.zeros(LANES), np.zeros(LANES), np.zeros(LANES)
    i = 2
    while i < record.size:
        if i + 4 <= record.size:
            a, b, d = record[i - 2], record[i - 1], record[i]
            e, f, g = record[i + 1], record[i + 2], record[i + 3]
            x0, x1, x2, x3 = exact[i], exact[i + 1], exact[i + 2], exact[i + 3]
            for j in range(LANES):
                k = (c[0, j], c[1, j], c[2, j], c[3, j], c[4, j])
                p = step(k, x[j], z[j], a, b, d)
                q = step(k, p, x[j], b, d, e)
                r = step(k, q, p, d, e, f)
                s = step(k, r, q, e, f, g)
                x[j], z[j] = s, r
                p, q, r, s = p - x0, q - x1, r - x2, s - x3
                squares[j] += (p * p + q * q) + (r * r + s * s)
                peak[j] = larger(peak[j], larger(larger(abs(p), abs(q)), larger(abs(r), abs(s))))
            i += 4
        else:
            for j in range(LANES):
                k = (c[0, j], c[1, j], c[2, j], c[3, j], c[4, j])
                x[j], z[j] = step(k, x[j], z[j], record[i - 2], record[i - 1], record[i]), x[j]
                squares[j] += (x[j] - exact[i]) ** 2
                peak[j] = larger(peak[j], abs(x[j] - exact[i]))
            i += 1
    return squares, peak


@numba.njit(fastmath=True)
def solve(acceleration: Numbers, ideal: tuple[float, ...], coefficients: Numbers) -> tuple[Numbers, Numbers]:
    """RMS^R and MTE^R of all cells, whose number is a multiple of the lanes."""
    record = np.zeros(acceleration.size + 2)
    record[2:] = acceleration
    exact = history(record, ideal)
    highest, cells = np.abs(exact).max(), coefficients.shape[1]
    rms, mte = np.empty(cells), np.empty(cells)
    for first in range(0, cells, LANES):
        squares, peak = lanes(record, exact, coefficients[:, first : first + LANES])
        for j in range(LANES):
            rms[first + j] = np.sqrt(squares[j] / acceleration.size) / highest
            mte[first + j] = peak[j] / highest
    return rms, mte


class Kernel:
    """The paper's grid before one structure, prepared for records of one step."""

    def __init__(self, structure: Structure, gain: Numbers, delay: Numbers, h: float) -> None:
        cells = structure.circular_frequency, structure.damping_ratio
        padding = -gain.size % LANES
        gains, delays = (np.append(values, np.repeat(values[-1], padding)) for values in (gain, delay))
        self.size, self.coefficients = gain.size, recursion(*cells, gains, delays, h)
        self.ideal = tuple(recursion(*cells, np.ones(1), np.zeros(1), h)[:, 0].tolist())

    def errors(self, acceleration: Numbers) -> tuple[Numbers, Numbers]:
        """RMS^R and MTE^R of each cell."""
        rms, mte = solve(acceleration, self.ideal, self.coefficients)
        return rms[: self.size], mte[: self.size]


def measure_in_turns(*works: Callable[[], object]) -> Numbers:
    """Processor times [s] of several works that take turns, shape (turns, works)."""
    for work in works:
        work()
    times = np.empty((TURNS, len(works)))
    for turn in times:
        for place, work in enumerate(works):
            start = time.process_time()
            work()
            turn[place] = time.process_time() - start
    return times


def compare(motion: Motion) -> str:
    """Speed and accuracy of both under one record."""
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    cells = ExplicitGrid().cells(structure)
    kernel = Kernel(structure, cells.gain, cells.delay, motion.time_step)

    def pole() -> object:
        return Loop(excitation=excitation, structure=structure, engine=Engine.POLE).deviation(cells)

    times = measure_in_turns(lambda: kernel.errors(motion.acceleration), pole)
    exact, ours = (
        Loop(excitation=excitation, structure=structure, engine=engine).deviation(cells)
        for engine in (Engine.SPECTRAL, Engine.POLE)
    )
    usual = cells.delay < 0.9 * critical_delay(structure, cells.gain)
    errors = [
        (np.sqrt(deviation.mean_square) / deviation.ideal_peak, deviation.peak / deviation.ideal_peak)
        for deviation in (exact, ours)
    ]
    rms, mte = (
        [float(np.abs(error - true)[usual].max()) for error in (kernel_errors, engine_errors)]
        for kernel_errors, engine_errors, true in zip(
            kernel.errors(motion.acceleration), errors[1], errors[0], strict=True
        )
    )
    ratio = float(np.median(times[:, 0] / times[:, 1]))
    return (
        f"{motion.name:24s} {1e3 * motion.time_step:5.4g} ms, {motion.duration:5.1f} s: ratio {ratio:.2f} "
        f"(shortest {1e3 * times[:, 0].min():.2f} and {1e3 * times[:, 1].min():.2f} ms); "
        f"largest error of RMS^R {rms[0]:.1e} and {rms[1]:.1e}, of MTE^R {mte[0]:.1e} and {mte[1]:.1e}"
    )


def main() -> None:
    threadpoolctl.threadpool_limits(1)
    if sys.argv[1:]:
        motions = [*load_motions(*sys.argv[1:])]
        steps = sorted({motion.time_step for motion in motions})
        records = [next(motion for motion in motions if motion.time_step == step_size) for step_size in steps]
    else:
        (motion, *_) = load_motions("synthetic")
        records = [resample(motion, rate) for rate in (200.0, 100.0, 50.0)]
    for motion in records:
        print(compare(motion))


if __name__ == "__main__":
    main()
