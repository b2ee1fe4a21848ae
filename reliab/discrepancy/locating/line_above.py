"""A line in a force at frequencies at which the motion is not known well enough to judge models.

Where only a noisy displacement was recorded, models of the specimen are judged up to the frequency at which
that displacement is mostly signal. A disturbance of one frequency may act above it. Its sharp line must stand
out of the residual in all stretches together; it must exceed the spring's response to a line of the
displacement; and it must not lie at a multiple of the mains' frequency, where it would be pickup.
"""

from dataclasses import dataclass

import numpy as np
from scipy import fft, ndimage, signal, stats

from reliab.arrays import Array
from reliab.discrepancy.campaign.campaign import Channel
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.spectra.segment import Segment
from reliab.signals import near_mains
from reliab.vocabulary import Block

_CHANCE = 1e-7  # that noise alone shows a line anywhere
_LEAST = 8.0  # times the power around it, on the average of the stretches
_BEYOND_SPRING = 9.0  # times the power with which the spring answers what the displacement shows
_AROUND = 25  # bins
_AUDIBLE = 0.05  # of the energy of all that is left: every recording has lines far below its noise


@dataclass(frozen=True, kw_only=True)
class Line:
    """A wave in a force."""

    frequency: float  # Frequency [Hz]
    amplitude: float  # Root mean square over the stretches of its amplitude [N]


def line_above(problem: Problem, best: Fit) -> Line | None:
    """Find the strongest line between the frequencies that are judged and the highest of a signal."""
    block = problem.block
    if block.block is not Block.SPECIMEN or block.highest >= block.highest_signal:
        return None
    longest = max(problem.segments, key=lambda segment: segment.end - segment.begin)
    grid = np.arange((longest.end - longest.begin) // 2) * block.rate / (longest.end - longest.begin)
    residual = problem.residuals(best.space, best.coordinates)
    forces = _powers(problem, residual, grid)
    motions = _powers(problem, {s.test: _displacement(problem, s.test) for s in problem.segments}, grid)
    specimen = best.space.model(best.coordinates).specimen
    spring = 0.0 if specimen is None else specimen.stiffness
    around = ndimage.median_filter(forces, (1, _AROUND)) / np.log(2.0)
    clear = np.mean(forces / np.maximum(around, 1e-300), axis=0)
    clear[forces.mean(axis=0) < _BEYOND_SPRING * spring**2 * motions.mean(axis=0)] = 0.0
    clear[(grid <= block.highest) | (grid >= block.highest_signal)] = 0.0
    clear[near_mains(grid, 0.5 * block.rate)] = 0.0
    place = int(np.argmax(clear))
    if clear[place] < _threshold(len(problem.segments), grid.size):
        return None
    amplitude = _amplitude(problem, residual, float(grid[place]))
    if 0.5 * amplitude**2 < _AUDIBLE * _mean_square(problem, residual):
        return None
    return Line(frequency=float(grid[place]), amplitude=amplitude)


def _threshold(stretches: int, trials: int) -> float:
    """Mean power over its expectation that noise exceeds by chance only."""
    return max(float(stats.gamma.isf(_CHANCE / trials, stretches)) / stretches, _LEAST)


def _mean_square(problem: Problem, values: dict[int, Array]) -> float:
    """Mean square over the segments of values without their means."""
    return float(
        np.mean([values[segment.test][segment.begin : segment.end].var() for segment in problem.segments])
    )


def _displacement(problem: Problem, test: int) -> Array:
    return problem.block.tests[test].channels[Channel.MEASURED]


def _powers(problem: Problem, values: dict[int, Array], grid: Array) -> Array:
    """Power of each segment under a window that keeps strong slow parts where they are, on one grid."""
    rows = []
    for segment in problem.segments:
        part = signal.detrend(values[segment.test][segment.begin : segment.end])
        power = np.abs(fft.rfft(part * signal.windows.hann(part.size, sym=False))) ** 2 / part.size
        rows.append(np.interp(grid, fft.rfftfreq(part.size, 1.0 / segment.rate), power))
    return np.stack(rows)


def _amplitude(problem: Problem, residual: dict[int, Array], frequency: float) -> float:
    """Root mean square over the segments of the amplitude of a frequency."""
    squares = [_amplitude_in(segment, residual[segment.test], frequency) ** 2 for segment in problem.segments]
    return float(np.sqrt(np.mean(squares)))


def _amplitude_in(segment: Segment, values: Array, frequency: float) -> float:
    part = values[segment.begin : segment.end]
    turn = 2.0 * np.pi * frequency / segment.rate * np.arange(part.size)
    weights = signal.windows.hann(part.size, sym=False)
    return float(2.0 * np.abs((weights * part) @ np.exp(-1j * turn)) / weights.sum())
