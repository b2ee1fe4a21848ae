"""The error by the discrete Fourier transform: an oracle of the recursion that shares nothing with it.

The transform runs along the line s = σ + iω a little right of the imaginary axis, on which the periodic
repetition decays. An input that is a straight line between samples has the transform ::

    U(s) = h H(s) Σ u_k e^(−skh) − u₀(e^(sh) − 1 − sh)/(s²h),      H(s) = e^(sh)((1 − e^(−sh))/(sh))²

(the second part takes away the ramp that the hold would start before the first sample). What is neglected
lies above half the sampling rate, where the transfer function and the hold fall with ω² each.
"""

import numpy as np
import scipy

_WRAPAROUND = 1e-11  # what is left of a response after one period of the transform


def filter_by_transform(transfer, values, time_step):
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
    return decayed * np.exp(shift * times)


def respond_spectrally(structure, difference, time_step):
    """Error of the interface from x_c − x_m, from rest [m]."""
    displacement = np.linalg.solve(structure.mass, structure.interface @ structure.specimen_mass)
    single_run = float((structure.interface.T @ displacement)[0, 0])
    remainder = filter_by_transform(
        lambda s: structure.error_transfer(s)[:, 0, 0] - single_run, difference, time_step
    )
    return single_run * difference + remainder
