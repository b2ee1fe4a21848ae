"""The recorded force as a second measurement of the specimen's displacement.

A linear specimen turns the displacement y into f = Z y, Z = k_e + c_e s + m_e s², so that the displacement
follows from the recorded force, y = f/Z (a proper transfer function). In the *force form* of the error
equation, γ(Z x_c − f), that y takes the place of the measured displacement: a force that is late or wrong
then shows in the error, but a stiffness k_e that is wrong by a few per cent looks like an actuator error and
can hide the real one. In the *combined* form the force's scale is taken from the measured displacement
itself, and the two readings are averaged with the weights that minimise noise: the stated k_e then has no
influence, a wrong scale of the force is not detected, and the channel with less noise counts more.

Transfer functions are applied by the discrete Fourier transform on the line s = σ + iω a little right of the
imaginary axis, along which the periodic repetition decays. An input that is a straight line between samples
has the transform ::

    U(s) = h H(s) Σ u_k e^(−skh) − u₀(e^(sh) − 1 − sh)/(s²h),      H(s) = e^(sh)((1 − e^(−sh))/(sh))²

(the second part takes away the ramp that the hold would start before the first sample). What is neglected
lies above half the sampling rate, where the transfer function and the hold fall with ω² each.
"""

from collections.abc import Callable
from enum import StrEnum

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.assessment.rebuilt_error.noise import estimate_noise
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.structures.partition import Partition

Transfer = Callable[[NDArray[np.complex128]], NDArray[np.complex128]]

_WRAPAROUND = 1e-11  # what is left of a response after one period of the transform

_TINY = 1e-12


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


class Form(StrEnum):
    """The channel from which the specimen's displacement is taken."""

    DISPLACEMENT = "displacement"
    FORCE = "force"
    COMBINED = "combined"


def felt_displacement(force: Array, structure: Partition, time_step: float) -> Array:
    """Displacement under which the linear specimen gives a force, f/Z.

    `time_step` [s]; returns [m].

    >>> from reliab.structures.structure import Structure
    >>> whole = Partition.of_structure(Structure(frequency=1.0, damping_ratio=0.02))
    >>> force = 39.4784176 * np.sin(np.arange(0.0, 3.0, 0.01))
    >>> round(float(felt_displacement(force, whole, 0.01)[100]), 6) == round(float(np.sin(1.0)), 6)
    True
    """
    stiffness = float(structure.specimen_stiffness[0, 0])
    if not stiffness > 0.0:
        raise InputError(
            "The displacement follows from the force only if the specimen has stiffness",
            value=f"k_e = {stiffness}",
            remedy="Use the displacement form",
        )
    damping, mass = (
        float(part[0, 0]) / stiffness for part in (structure.specimen_damping, structure.specimen_mass)
    )
    if damping == 0.0 and mass == 0.0:
        return force / stiffness
    return filtered(lambda s: 1.0 / (1.0 + damping * s + mass * s**2), force / stiffness, time_step)


def combined_reading(command: Array, measured: Array, felt: Array, time_step: float) -> Array:
    """Average of two readings of the displacement that has the least noise.

    `command`, `measured`, `felt` [m]; `time_step` [s]; returns [m].

    >>> generator = np.random.default_rng(1)
    >>> time = np.arange(0.0, 40.0, 0.002)
    >>> moved = np.sin(6.0 * time) * np.sin(0.08 * time) ** 2
    >>> noisy = moved + 0.01 * generator.normal(size=time.size)
    >>> quiet = 1.05 * moved + 0.001 * generator.normal(size=time.size)
    >>> average = combined_reading(moved, noisy, quiet, 0.002)
    >>> bool(np.std(average - moved) < 0.0015)
    True
    """
    basis = np.stack([measured, np.ones(measured.size)])
    scale, zero = np.linalg.lstsq(basis @ basis.T, basis @ felt, rcond=None)[0]
    if not scale > 0.0:
        raise InputError(
            "The force must grow with the measured displacement",
            value=f"a slope of {significant(scale)} of what the specimen's stiffness says",
            remedy="Check the sign of the force",
        )
    stated = (felt - zero) / scale
    noise = [
        estimate_noise(command, reading, time_step).white ** 2 + _TINY * float(reading @ reading)
        for reading in (measured, stated)
    ]
    weight = noise[1] / (noise[0] + noise[1])
    return np.asarray(weight * measured + (1.0 - weight) * stated)
