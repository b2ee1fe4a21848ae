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
def at_samples(a: NDArray[np.float64], weights: Weights) -> NDArray[np.complex128]:
    """Exact z at the samples of a record, from rest at the first."""
    early, late, decay = weights
    z = np.empty(a.size, dtype=np.complex128)
    x, y = 0.0, 0.0
    z[0] = 0.0
    for i in range(a.size - 1):
        u = (early.real * a[i] + late.real * a[i + 1]) + (decay.real * x - decay.imag * y)
        v = (early.imag * a[i] + late.imag * a[i + 1]) + (decay.real * y + decay.imag * x)
        x, y = u, v
        z[i + 1] = complex(x, y)
    return z


@compiled
def at_time(
    a: NDArray[np.float64], h: float, pole: complex, samples: NDArray[np.complex128], time: float
) -> complex:
    """Exact z at a time [s], zero before the record starts."""
    if time <= 0.0:
        return 0j
    i = min(int(time / h + 1e-9), a.size - 2)
    into = time - i * h
    if into < _AT_SAMPLE * h:
        return complex(samples[i])
    # z(t + s) = e^(ps)z + a(e^(ps) − 1)/p + a'(e^(ps) − 1 − ps)/p²
    grown = np.exp(pole * into)
    held = (grown - 1.0) / pole
    return complex(grown * samples[i] + a[i] * held + (a[i + 1] - a[i]) / h * (held - into) / pole)


@compiled
def cut_record(
    record: tuple[NDArray[np.float64], float],
    pole: complex,
    weights: tuple[Weights, Weights],
    first: float,
    step: float,
    blocks: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Straight lines that drive the mode from edge to edge, and the exact response there.

    Parameters
    ----------
    record : tuple
        Ground acceleration [m/s²] and its time step [s].
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
        Ground acceleration at the ends of each block, shape (blocks,).
    ideal : numpy.ndarray
        Exact response x_I [m] at the edges, shape (blocks + 1,).
    """
    a, h = record
    samples = at_samples(a, weights[0])
    early, late, decay = weights[1]
    determinant = early.real * late.imag - early.imag * late.real
    left, right, ideal = np.empty(blocks), np.empty(blocks), np.empty(blocks + 1)
    before = at_time(a, h, pole, samples, first)
    ideal[0] = -before.imag / pole.imag  # x_I = −2Re(z/(p − p̄))
    for k in range(blocks):
        after = at_time(a, h, pole, samples, first + step * (k + 1.0))
        u = after.real - (decay.real * before.real - decay.imag * before.imag)
        v = after.imag - (decay.real * before.imag + decay.imag * before.real)
        left[k] = (late.imag * u - late.real * v) / determinant
        right[k] = (early.real * v - early.imag * u) / determinant
        ideal[k + 1] = -after.imag / pole.imag
        before = after
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
    record, pole, step
        As of `cut_record`.
    weights : tuple
        Weights of the mode over a sample.
    ideal : numpy.ndarray
        Exact response [m] at the edges inside the window.
    window : tuple of float
        Begin and end of the window [s].
    """
    a, h = record
    samples = at_samples(a, weights)
    high = 0.0
    for edge in ideal:
        high = max(high, abs(edge))
    largest = 0.0
    for k in range(ideal.size - 1):
        if max(abs(ideal[k]), abs(ideal[k + 1])) >= _NEAR_PEAK * high:
            for part in range(_PARTS + 1):
                time = min(window[0] + step * (k + part / _PARTS), window[1])
                largest = max(largest, abs(at_time(a, h, pole, samples, time).imag))
    return largest / pole.imag
