"""Lines in the spectrum of what a model leaves over."""

import numpy as np

from reliab.arrays import Array
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.terms.periodic import Disturbance, disturbance
from reliab.effects import Role
from reliab.signals import near_mains
from reliab.vocabulary import Block

_HIGH = 25.0  # times the noise's power, on the average of the segments
_LOWEST = 0.2  # Hz
_NEAR_ZERO = 2  # frequencies of a segment above zero that cannot be told from a drift


def line_terms(problem: Problem, fitted: Fit) -> tuple[type[Disturbance], ...]:
    """Make a term of the strongest line in a model's residual, if one stands out and is not mains pickup."""
    longest = max(problem.segments, key=lambda segment: segment.end - segment.begin)
    frequency = longest.frequency
    if frequency.size <= _NEAR_ZERO + 1:
        return ()
    power = np.mean(
        [np.interp(frequency, frequencies, rows) for frequencies, rows in _powers(problem, fitted.residual)],
        axis=0,
    )
    power[: _NEAR_ZERO + 1] = 0.0
    power[(frequency < _LOWEST) | near_mains(frequency, 0.5 * problem.block.rate)] = 0.0
    place = int(np.argmax(power))
    if power[place] < _HIGH:
        return ()
    role = Role.FORCE if problem.block.block is Block.SPECIMEN else Role.DISPLACEMENT_READING
    return (disturbance(role, float(frequency[place]), float(frequency[1])),)


def _powers(problem: Problem, residual: Array) -> list[tuple[Array, Array]]:
    """Frequencies and whitened power of each segment."""
    spectra, begin = [], 0
    for segment in problem.segments:
        rows = residual[begin : begin + 2 * segment.bins - 1]
        begin += rows.size
        real, imaginary = rows[1 : segment.bins], rows[segment.bins :]
        power = np.concatenate([rows[:1] ** 2, 0.5 * (real**2 + imaginary**2)])
        spectra.append((segment.frequency, power))
    return spectra
