"""Histories of x_c − x_m of several actuators that are compatible with their sensors' noise.

With one actuator noise and error are told apart by their spectra (`rebuilt_error/difference_draws.py`). With
several, noise may stand in several channels at once (one sensor enters both x and θ of a node, amplifiers
share a supply), and so does the error (two parallel actuators are late together, and θ is their difference).
Drawn for each channel by itself, what cancels in truth would not, and every draw would err by too much. The
channels are therefore mixed, z = B y, such that neither noise nor error have a covariance between them ::

    B N Bᵀ = I,   B D Bᵀ = Λ

with N the covariance of the sensors' noise, read above half of the Nyquist frequency, and D that of what the
commands do not explain within the band of the motion. Each z is drawn by itself and follows all commands.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from reliab.assessment.rebuilt_error.difference_draws import coarse_step, draw_differences
from reliab.assessment.rebuilt_error.noise import SensorNoise, estimate_noise, follow_commands
from reliab.core.arrays import Array

_LEAST_NOISE = 1e-9  # of the motion: channels with less are taken to be without noise
_FILTER_FACTOR = 2.5  # times the band: above, the filter lets nothing pass
_LINES = 8.0  # times the median of the bins: a line of the mains and no noise


def draw_jointly(
    command: Array,
    measured_displacement: Array,
    noises: Sequence[SensorNoise],
    frequency: float,
    stride: int,
    draws: int,
    seed: int,
) -> Array:
    """Draw histories of x_c − x_m at each `stride`-th sample [m], shape (draws, p, ceil(n/every)).

    `command`, `measured_displacement` [m], shape (p, n), of actuators that all move; `noises` of one band,
    since a mode may ring in one mixture and hardly show in another; `frequency` [Hz]. Rows 0, 2, … assume
    that there is no slow noise.
    """
    mixing = _mixing(command, measured_displacement, noises)
    mixed_commands, read = mixing @ command, mixing @ measured_displacement
    differences = np.empty((draws, len(mixed_commands), -(-command.shape[1] // stride)))
    for place, (mixed_command, mixed_reading) in enumerate(zip(mixed_commands, read, strict=True)):
        other_commands = np.delete(mixed_commands, place, axis=0)
        noise = replace(
            estimate_noise(mixed_command, mixed_reading, noises[place].time_step, other_commands),
            band=noises[place].band,
            ripple=noises[place].ripple,
        )
        differences[:, place] = draw_differences(
            mixed_command,
            mixed_reading,
            noise,
            frequency,
            stride,
            draws,
            seed + 7919 * place,
            other_commands,
            highest=_FILTER_FACTOR * noise.band,
        )
    return np.asarray(np.linalg.inv(mixing) @ differences)


def _mixing(command: Array, measured_displacement: Array, noises: Sequence[SensorNoise]) -> Array:
    """B, the identity where channels are rounded so coarsely that their noise is not white."""
    if len(command) == 1 or any(map(coarse_step, measured_displacement, noises)):
        return np.eye(len(command))
    residual = measured_displacement - follow_commands(command, measured_displacement, noises[0].time_step)
    smooth_residual = np.stack([noise.smooth(row) for noise, row in zip(noises, residual, strict=True)])
    _, vectors = scipy.linalg.eigh(
        np.cov(smooth_residual), _noise_covariance(residual, measured_displacement)
    )
    return np.asarray(vectors.T)


def _noise_covariance(residual: Array, measured_displacement: Array) -> Array:
    """N [m²], from the spectra above half of the Nyquist frequency."""
    spectra = np.fft.rfft(residual, axis=1)[:, 1:]
    upper = spectra[:, spectra.shape[1] // 2 :] / np.sqrt(residual.shape[1])
    power = np.abs(upper) ** 2
    plain = (power <= _LINES * np.median(power, axis=1, keepdims=True)).all(axis=0)
    coefficients = upper[:, plain]
    covariance = (coefficients @ coefficients.conj().T).real / max(coefficients.shape[1], 1)
    least = (_LEAST_NOISE * measured_displacement.std(axis=1)) ** 2
    return np.asarray(covariance + np.diag(np.maximum(least, np.finfo(float).tiny)))
