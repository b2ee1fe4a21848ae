"""The frequency band in which a test is analysed, and the coarser time grid that represents it.

Histories are transformed along the line s = σ + iω of the Laplace plane. The shift σ damps whatever a linear
filter leaves ringing after the end of the record before it wraps around to the beginning, so that filters of
lightly damped structures act as they do on a history that starts from rest.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import ArrayLike

from reliab.core.arrays import Array, Spectrum

_WRAP_AROUND = 1e-5  # of a response, that may return to the beginning of the record
_ROLL_OFF = 0.85  # of the band: above, the transform falls to zero, so that its edge does not ring
_POINTS = 2.6  # time points per period of the highest frequency
_FADE = 2.0  # periods of the structure in which a record that ends in motion is faded out
_POWER = 1e-6  # of the command's power that may lie above the band
_WIDEST = 0.45  # of the sampling rate
_PERIODS = 6.0  # highest frequency of the band over the structure's lowest, at least


@dataclass(frozen=True, kw_only=True, eq=False)
class AnalysisBand:
    """Complex frequencies and coarse time steps of an analysis.

    >>> band = AnalysisBand.choose(samples=4000, time_step=0.01, lowest=1.0, highest=8.0, decay=0.1)
    >>> wave = np.sin(2.0 * np.pi * np.arange(4000) * 0.01)
    >>> coarse = band.history(band.spectrum(wave))
    >>> bool(np.allclose(coarse[10:], np.sin(2.0 * np.pi * band.time[10:]), atol=1e-2))
    True
    """

    record_samples: int  # Samples n of the record
    record_step: float  # Their step [s]
    fade: int  # Samples in which the record is faded out after its end
    points: int  # Samples of the transform, record and silence after it
    bins: int  # Frequencies K that are kept
    coarse_points: int  # Points of the coarse grid, over the whole transform
    shift: float  # σ [rad/s]

    @classmethod
    def choose(
        cls, *, samples: int, time_step: float, lowest: float, highest: float, decay: float
    ) -> "AnalysisBand":
        """Choose the band of a record.

        `time_step` [s]; `lowest`: natural frequency of the structure, `highest` of the band [Hz]; `decay`:
        rate ξω [1/s] at which its slowest vibration dies out.
        """
        fade = min(int(_FADE / (lowest * time_step)), samples)
        points = scipy.fft.next_fast_len(2 * (samples + fade), real=True)
        length = points * time_step
        silence = length - (samples + fade) * time_step
        shift = max(-np.log(_WRAP_AROUND) - decay * silence, 0.0) / length
        bins = min(int(highest * length), points // 2)
        coarse = scipy.fft.next_fast_len(max(int(_POINTS * bins), 64), real=True)
        return cls(
            record_samples=samples,
            record_step=time_step,
            fade=fade,
            points=points,
            bins=bins,
            coarse_points=coarse + coarse % 2,
            shift=shift,
        )

    @cached_property
    def s(self) -> Spectrum:
        """Complex frequencies s = σ + iω [rad/s], shape (K,)."""
        angular = 2.0 * np.pi * np.arange(self.bins) / (self.points * self.record_step)
        return np.asarray(self.shift + 1j * angular)

    def advance(self, times: ArrayLike) -> Spectrum:
        """Return e^(sT) of times T [s], shape (…,), by which it makes histories earlier, shape (…, K).

        Frequencies are equally spaced, so that each factor is a product of two from short lists.
        """
        stride, column = math.isqrt(self.bins - 1) + 1, np.asarray(times)[..., np.newaxis]
        coarse, fine = np.exp(column * self.s[::stride]), np.exp(column * (self.s[:stride] - self.shift))
        products = coarse[..., np.newaxis] * fine[..., np.newaxis, :]
        return np.asarray(products.reshape(*column.shape[:-1], -1)[..., : self.bins])

    @cached_property
    def _taper(self) -> Array:
        place = np.arange(self.bins) / self.bins
        position = np.clip((place - _ROLL_OFF) / (1.0 - _ROLL_OFF), 0.0, 1.0)
        return np.asarray(0.5 + 0.5 * np.cos(np.pi * position))

    @property
    def time_step(self) -> float:
        """Step of the coarse grid [s]."""
        return self.points * self.record_step / self.coarse_points

    @cached_property
    def time(self) -> Array:
        """Coarse times within the record [s], shape (m,)."""
        return np.asarray(np.arange(self.samples) * self.time_step)

    @property
    def samples(self) -> int:
        """Number m of coarse samples within the record."""
        return int((self.record_samples - 1) * self.record_step / self.time_step) + 1

    @property
    def flat(self) -> float:
        """Highest frequency that passes unchanged [Hz]."""
        return _ROLL_OFF * self.bins / (self.points * self.record_step)

    @property
    def noise_gain(self) -> float:
        """Variance of a coarse lapped coefficient of white noise over that of a record's sample [-]."""
        return self.record_step / self.time_step

    def spectrum(self, values: Array) -> Spectrum:
        """Transform histories on the record's grid, shape (…, n), to shape (…, K)."""
        return self._transform(values, self._decay, self.fade)

    def from_laplace(self, transform: Spectrum) -> Spectrum:
        """Put the Laplace transform of histories [s], shape (…, K), on the scale of their spectra."""
        return np.asarray(transform * self._taper / self.record_step)

    def coarse_spectrum(self, values: Array) -> Spectrum:
        """Transform histories on the coarse grid, shape (…, m), to shape (…, K)."""
        fade = int(self.fade * self.record_step / self.time_step)
        spectrum = self._transform(values, self._coarse_decay, fade)
        return np.asarray(spectrum * (self.points / self.coarse_points))

    @cached_property
    def _decay(self) -> Array:
        return np.asarray(np.exp(-self.shift * self.record_step * np.arange(self.points)))

    @cached_property
    def _coarse_decay(self) -> Array:
        return np.asarray(np.exp(-self.shift * self.time_step * np.arange(self.coarse_points)))

    def _transform(self, values: Array, decay: Array, fade: int) -> Spectrum:
        """Transform histories that are continued point-symmetrically beyond their end and faded out."""
        size = values.shape[-1]
        full = np.zeros((*values.shape[:-1], decay.size))
        full[..., :size] = values
        reach = min(fade, size - 1)
        weight = 0.5 + 0.5 * np.cos(np.pi * (np.arange(reach) + 0.5) / reach)
        full[..., size : size + reach] = weight * (2.0 * values[..., -1:] - values[..., -2 : -reach - 2 : -1])
        return np.asarray(scipy.fft.rfft(full * decay)[..., : self.bins] * self._taper)

    def history(self, spectrum: Spectrum) -> Array:
        """Return histories on the coarse grid within the record, shape (…, m)."""
        full = scipy.fft.irfft(spectrum, self.coarse_points) * (self.coarse_points / self.points)
        return np.asarray(full[..., : self.samples] * self._growth)

    @cached_property
    def _growth(self) -> Array:
        return np.asarray(np.exp(self.shift * self.time))

    def full_history(self, spectrum: Spectrum) -> Array:
        """Return histories on the record's own grid, shape (…, n)."""
        full = scipy.fft.irfft(spectrum, self.points)[..., : self.record_samples]
        return np.asarray(full * np.exp(self.shift * self.record_step * np.arange(self.record_samples)))


def highest_frequency(command: Array, time_step: float, lowest: float) -> float:
    """Highest frequency [Hz] that an analysis needs: what the commands hold, and well above the structure's.

    `command` [m], shape (p, n); `lowest`: natural frequency of the structure [Hz].
    """
    window = np.hanning(command.shape[-1])
    power = np.abs(scipy.fft.rfft((command - command.mean(axis=-1, keepdims=True)) * window)) ** 2
    total = np.cumsum(power / (power.sum(axis=-1, keepdims=True) + np.finfo(float).tiny), axis=-1).min(axis=0)
    highest = int(np.searchsorted(total, 1.0 - _POWER)) / (command.shape[-1] * time_step)
    return float(min(max(1.3 * highest, _PERIODS * lowest) / _ROLL_OFF, _WIDEST / time_step))
