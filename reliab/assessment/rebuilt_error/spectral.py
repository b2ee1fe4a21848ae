"""The same error by the discrete Fourier transform, as an independent check of the recursion.

The transform is taken on the line s = σ + iω a little right of the imaginary axis, along which the periodic
repetition decays. An input that is a straight line between samples has the transform ::

    U(s) = h H(s) Σ u_k e^(−skh) − u₀(e^(sh) − 1 − sh)/(s²h),      H(s) = e^(sh)((1 − e^(−sh))/(sh))²

(the second part takes away the ramp that the hold would start before the first sample). What is neglected
lies above half the sampling rate, where the transfer function and the hold fall with ω² each.
"""

from collections.abc import Callable

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.structures import Partition

Transfer = Callable[[NDArray[np.complex128]], NDArray[np.complex128]]

_WRAPAROUND = 1e-11  # what is left of a response after one period of the transform


def respond_spectrally(structure: Partition, difference: Array, time_step: float) -> Array:
    """Error of the interface from x_c − x_m, from rest.

    `difference` [m]; `time_step` [s]; returns [m].

    >>> from reliab.structures.structure import Structure
    >>> half = Structure(frequency=1.0, damping_ratio=0.2, experimental_fraction=0.5)
    >>> error = respond_spectrally(Partition.of_structure(half), np.ones(2000), 0.01)
    >>> round(float(error[-1]), 4)
    0.5
    """
    moved = np.linalg.solve(structure.mass, structure.interface @ structure.specimen_mass)
    at_once = float((structure.interface.T @ moved)[0, 0])
    rest = filtered(lambda s: structure.error_transfer(s)[:, 0, 0] - at_once, difference, time_step)
    return at_once * difference + rest


def filtered(transfer: Transfer, values: Array, time_step: float) -> Array:
    """Response of a proper transfer function to a piecewise-linear input, from rest, shape (n,)."""
    points = scipy.fft.next_fast_len(2 * values.size, real=True)
    shift = -np.log(_WRAPAROUND) / (points * time_step)
    times = time_step * np.arange(values.size)
    s = shift + 2j * np.pi / (points * time_step) * np.arange(points // 2 + 1)
    sh = s * time_step
    hold = np.exp(sh) * (-np.expm1(-sh) / sh) ** 2
    ramp = values[0] * (np.expm1(sh) - sh) / (sh * sh)
    spectrum = hold * scipy.fft.rfft(values * np.exp(-shift * times), points) - ramp
    decayed = scipy.fft.irfft(spectrum * transfer(s), points)[: values.size]
    return np.asarray(decayed * np.exp(shift * times))
