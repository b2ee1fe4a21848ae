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
_PASSED = 2.5  # times the band: above, the filter lets nothing pass
_LINES = 8.0  # times the median of the bins: a line of the mains and no noise


def draw_jointly(
    command: Array,
    measured: Array,
    noises: Sequence[SensorNoise],
    frequency: float,
    every: int,
    draws: int,
    seed: int,
) -> Array:
    """Draw histories of x_c − x_m at each `every`-th sample [m], shape (draws, p, ceil(n/every)).

    `command`, `measured` [m], shape (p, n), of actuators that all move; `noises` of one band, since a mode
    may ring in one mixture and hardly show in another; `frequency` [Hz]. Rows 0, 2, … assume that there is no
    slow noise.
    """
    mixing = _mixing(command, measured, noises)
    told, read = mixing @ command, mixing @ measured
    drawn = np.empty((draws, len(told), -(-command.shape[1] // every)))
    for place, (one, shown) in enumerate(zip(told, read, strict=True)):
        others = np.delete(told, place, axis=0)
        noise = replace(
            estimate_noise(one, shown, noises[place].time_step, others),
            band=noises[place].band,
            ripple=noises[place].ripple,
        )
        drawn[:, place] = draw_differences(
            one,
            shown,
            noise,
            frequency,
            every,
            draws,
            seed + 7919 * place,
            others,
            highest=_PASSED * noise.band,
        )
    return np.asarray(np.linalg.inv(mixing) @ drawn)


def _mixing(command: Array, measured: Array, noises: Sequence[SensorNoise]) -> Array:
    """B, the identity where channels are rounded so coarsely that their noise is not white."""
    if len(command) == 1 or any(map(coarse_step, measured, noises)):
        return np.eye(len(command))
    rest = measured - follow_commands(command, measured, noises[0].time_step)
    within = np.stack([noise.smooth(row) for noise, row in zip(noises, rest, strict=True)])
    _, vectors = scipy.linalg.eigh(np.cov(within), _noise_covariance(rest, measured))
    return np.asarray(vectors.T)


def _noise_covariance(rest: Array, measured: Array) -> Array:
    """N [m²], from the spectra above half of the Nyquist frequency."""
    spectra = np.fft.rfft(rest, axis=1)[:, 1:]
    upper = spectra[:, spectra.shape[1] // 2 :] / np.sqrt(rest.shape[1])
    power = np.abs(upper) ** 2
    plain = (power <= _LINES * np.median(power, axis=1, keepdims=True)).all(axis=0)
    kept = upper[:, plain]
    covariance = (kept @ kept.conj().T).real / max(kept.shape[1], 1)
    least = (_LEAST_NOISE * measured.std(axis=1)) ** 2
    return np.asarray(covariance + np.diag(np.maximum(least, np.finfo(float).tiny)))
