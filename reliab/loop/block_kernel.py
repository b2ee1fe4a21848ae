"""The compiled loops that follow the structure's own mode and cut a record into blocks (`blocks`).

The mode is z' = pz + a_g. Complex numbers are multiplied in their parts, without the search for NaN that a
compiler adds to a complex product.
"""

import numpy as np
from numpy.typing import NDArray

from reliab.compiled import compiled

_AT_SAMPLE = 1e-9  # of the record's step; a time closer than this to a sample counts as that sample's
_NEAR_PEAK = 0.97  # a block that ends this high may hold the peak of the exact response
_PARTS = 16  # into which such a block is divided

Weights = tuple[complex, complex, complex]
"""F₀, F₁ and decay of a mode, as of `blocks.ramp_weights`."""


@compiled
def at_samples(records: NDArray[np.float64], weights: Weights) -> NDArray[np.float64]:
    """Exact z at the samples of records, from rest at the first.

    Shape (samples, 2 records): real and imaginary part under the first record, then under the next.
    """
    early, late, decay = weights
    count, samples = records.shape
    z = np.zeros((samples, 2 * count))
    for m in range(count):
        x, y = 0.0, 0.0
        for i in range(samples - 1):
            a, b = records[m, i], records[m, i + 1]
            u = (early.real * a + late.real * b) + (decay.real * x - decay.imag * y)
            v = (early.imag * a + late.imag * b) + (decay.real * y + decay.imag * x)
            x, y = u, v
            z[i + 1, 2 * m], z[i + 1, 2 * m + 1] = x, y
    return z


@compiled
def at_time(
    records: NDArray[np.float64],
    h: float,
    pole: complex,
    samples: NDArray[np.float64],
    time: float,
    z: NDArray[np.float64],
) -> None:
    """Exact z at a time [s] into an array of shape (2 records,); zero before the records start."""
    if time <= 0.0:
        for j in range(z.size):
            z[j] = 0.0
        return
    i = min(int(time / h + 1e-9), records.shape[1] - 2)
    into = time - i * h
    if into < _AT_SAMPLE * h:
        for j in range(z.size):
            z[j] = samples[i, j]
        return
    # z(t + s) = e^(ps)z + a(e^(ps) − 1)/p + a'(e^(ps) − 1 − ps)/p²
    inverse = 1.0 / pole
    grown = np.exp(pole * into)
    held = (grown - 1.0) * inverse
    ramp = (held - into) * inverse
    for m in range(records.shape[0]):
        a, slope = records[m, i], (records[m, i + 1] - records[m, i]) / h
        x, y = samples[i, 2 * m], samples[i, 2 * m + 1]
        z[2 * m] = grown.real * x - grown.imag * y + a * held.real + slope * ramp.real
        z[2 * m + 1] = grown.imag * x + grown.real * y + a * held.imag + slope * ramp.imag


@compiled
def cut_records(
    records: NDArray[np.float64],
    h: float,
    pole: complex,
    weights: tuple[Weights, Weights],
    first: float,
    step: float,
    blocks: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Straight lines that drive the mode from edge to edge, and the exact response there.

    Parameters
    ----------
    records : numpy.ndarray
        Ground accelerations [m/s²] at the same instants, shape (records, samples).
    h : float
        Their time step [s].
    pole : complex
        Pole p [1/s].
    weights : tuple
        Weights of the mode over a sample and over a block.
    first : float
        Time of the first edge [s].
    step : float
        Length of a block [s].
    blocks : int
        Number of blocks.

    Returns
    -------
    left, right : numpy.ndarray
        Ground acceleration at the ends of each block, shape (records, blocks).
    ideal : numpy.ndarray
        Exact response x_I [m] at the edges, shape (records, blocks + 1).
    """
    samples, count = at_samples(records, weights[0]), records.shape[0]
    early, late, decay = weights[1]
    determinant = early.real * late.imag - early.imag * late.real
    left, right = np.empty((count, blocks)), np.empty((count, blocks))
    ideal = np.empty((count, blocks + 1))
    before, after = np.empty(2 * count), np.empty(2 * count)
    at_time(records, h, pole, samples, first, before)
    for m in range(count):
        ideal[m, 0] = -before[2 * m + 1] / pole.imag  # x_I = −2Re(z/(p − p̄))
    for k in range(blocks):
        at_time(records, h, pole, samples, first + step * (k + 1.0), after)
        for m in range(count):
            x, y = before[2 * m], before[2 * m + 1]
            u = after[2 * m] - (decay.real * x - decay.imag * y)
            v = after[2 * m + 1] - (decay.real * y + decay.imag * x)
            left[m, k] = (late.imag * u - late.real * v) / determinant
            right[m, k] = (early.real * v - early.imag * u) / determinant
            ideal[m, k + 1] = -after[2 * m + 1] / pole.imag
        before, after = after, before
    return left, right, ideal


@compiled
def peak_of_mode(
    record: tuple[NDArray[np.float64], float],
    pole: complex,
    weights: Weights,
    ideal: NDArray[np.float64],
    window: tuple[float, float],
    step: float,
) -> float:
    """Largest |x_I| [m] inside the window, between the edges of blocks too.

    Parameters
    ----------
    record : tuple
        Ground acceleration [m/s²], shape (1, samples), and its time step [s].
    pole, step
        As of `cut_records`.
    weights : tuple
        Weights of the mode over a sample.
    ideal : numpy.ndarray
        Exact response [m] at the edges inside the window.
    window : tuple of float
        Begin and end of the window [s].
    """
    a, h = record
    samples, z = at_samples(a, weights), np.empty(2)
    high = 0.0
    for edge in ideal:
        high = max(high, abs(edge))
    largest = 0.0
    for k in range(ideal.size - 1):
        if max(abs(ideal[k]), abs(ideal[k + 1])) >= _NEAR_PEAK * high:
            for part in range(_PARTS + 1):
                time = min(window[0] + step * (k + part / _PARTS), window[1])
                at_time(a, h, pole, samples, time, z)
                largest = max(largest, abs(z[1]))
    return largest / pole.imag
