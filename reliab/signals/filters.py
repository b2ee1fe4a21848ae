"""Low-pass filters: symmetric ones without delay, recursive ones, and Butterworth's before a converter."""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.signals.spectra import convolve_valid

_ORDERS = range(1, 9)
_ROOM = 0.9  # of the Nyquist frequency: a wider pass band is no filter
_RIPPLE = 60.0  # dB, how far the deviations of a filter lie below one

REACH = 0.2
"""Share of a history that a filter may reach to one side."""


def low_pass(edge: float, rate: float) -> Array:
    """Design a symmetric low-pass filter.

    `edge`: frequency [Hz] at which half of the amplitude passes; `rate`: sampling rate [Hz].
    Returns coefficients, shape (odd,); the single 1 where the edge is too near to the Nyquist frequency.

    >>> low_pass(49.0, 100.0).tolist(), low_pass(10.0, 100.0).size % 2
    ([1.0], 1)
    """
    nyquist = 0.5 * rate
    if not edge < _ROOM * nyquist:
        return np.ones(1)
    reach = _kaiser_taps(0.6 * edge / nyquist) // 2
    beta = 0.1102 * (_RIPPLE - 8.7)  # Kaiser (1974)
    places = np.arange(-reach, reach + 1, dtype=np.float64)
    taper = scipy.special.i0(beta * np.sqrt(1.0 - (places / reach) ** 2)) / scipy.special.i0(beta)
    taps = edge / nyquist * np.sinc(edge / nyquist * places) * taper
    return np.asarray(taps / taps.sum())


def _kaiser_taps(width: float) -> int:
    """Odd number of coefficients of Kaiser's design, for a transition as wide as a share of Nyquist's."""
    return int(np.ceil((_RIPPLE - 7.95) / 2.285 / (np.pi * width) + 1.0)) | 1


def filter_symmetrically(values: Array, coefficients: Array) -> Array:
    """Pass histories through a symmetric filter.

    Beyond its ends the history is continued point-symmetrically about the end of a straight line through
    the nearest samples, so that the noise of the last sample is not continued with it.

    `values`: histories, shape (…, n); `coefficients`: the filter, shape (odd,). Returns the filtered
    histories, shape (…, n); the histories themselves where the filter is long beside them.

    >>> line = np.arange(20.0)
    >>> bool(np.allclose(filter_symmetrically(line, np.array([0.25, 0.5, 0.25])), line))
    True
    """
    reach = coefficients.size // 2
    if reach == 0 or reach > REACH * values.shape[-1]:
        return values
    start_extension = 2.0 * _end_of_line(values[..., reach::-1]) - values[..., reach:0:-1]
    end_extension = 2.0 * _end_of_line(values[..., -reach - 1 :]) - values[..., -2 : -reach - 2 : -1]
    return convolve_valid(np.concatenate([start_extension, values, end_extension], axis=-1), coefficients)


def _end_of_line(values: Array) -> Array:
    """Last value of the straight line of least squares through each row of values, shape (…, 1)."""
    size = values.shape[-1]
    place = np.arange(size) - 0.5 * (size - 1)
    slope = (values @ place) / float(place @ place)
    return np.asarray(values.mean(axis=-1) + slope * float(place[-1]))[..., np.newaxis]


def filter_recursively(numerator: Array, denominator: Array, values: Array) -> Array:
    """Pass a history through Σ a_k y[i-k] = Σ b_k x[i-k] from rest.

    `numerator`: b, shape (m,); `denominator`: a with a₀ = 1, shape (k,); `values`: x, shape (n,). Returns y,
    shape (n,), by a triangular system of equations.

    >>> filter_recursively(np.array([1.0]), np.array([1.0, -0.5]), np.array([1.0, 0.0, 0.0])).tolist()
    [1.0, 0.5, 0.25]
    """
    forward_part = np.convolve(values, numerator)[: values.size]
    band = np.repeat(denominator[:, np.newaxis], values.size, axis=1)
    solution, _ = scipy.linalg.lapack.dtbtrs(band, forward_part, uplo="L", diag="U")
    return np.asarray(solution).reshape(values.size)


def butterworth_poles(order: int) -> NDArray[np.complex128]:
    """Poles of Butterworth's low-pass filter with the corner 1 rad/s, shape (order,).

    >>> [complex(pole.round(4)) for pole in butterworth_poles(2)]
    [(-0.7071+0.7071j), (-0.7071-0.7071j)]
    """
    place = np.arange(-order + 1, order, 2)
    return np.asarray(-np.exp(1j * np.pi * place / (2 * order)))


@dataclass(frozen=True, kw_only=True)
class LowPass:
    """Low-pass filter of Butterworth's kind before a converter."""

    corner: float  # Frequency at which half of the power passes [Hz]
    order: int = 2  # Order

    @classmethod
    def parse(cls, text: str) -> "LowPass":
        """Read "200" or "200/4": corner [Hz] and order.

        >>> LowPass.parse("200/4")
        LowPass(corner=200.0, order=4)
        """
        corner, _, order = text.partition("/")
        try:
            low_pass = cls(corner=float(corner), order=int(order or 2))
        except ValueError:
            low_pass = cls(corner=0.0)
        if not (np.isfinite(low_pass.corner) and low_pass.corner > 0.0 and low_pass.order in _ORDERS):
            raise InputError(
                "No low-pass filter: it has a corner frequency above 0 Hz and an order of 1 to 8",
                value=repr(text),
                remedy="Write 200 for a filter of second order at 200 Hz, 200/4 for one of fourth order",
            )
        return low_pass

    @property
    def delay(self) -> float:
        """Delay of slow motions [s].

        >>> round(1e3 * LowPass(corner=100.0).delay, 2)
        2.25
        """
        return float(np.sum(-1.0 / butterworth_poles(self.order)).real / (2.0 * np.pi * self.corner))

    def power(self, frequency: Array) -> Array:
        """Share of the power that passes at frequencies [Hz]."""
        return np.asarray(1.0 / (1.0 + (frequency / self.corner) ** (2 * self.order)))

    def apply(self, values: Array, time_step: float) -> Array:
        """Pass histories through the filter, exactly for straight lines between samples, shape (…, n)."""
        zeros, poles, gain = scipy.signal.butter(
            self.order, 2.0 * np.pi * self.corner, analog=True, output="zpk"
        )
        system = scipy.signal.cont2discrete(scipy.signal.zpk2ss(zeros, poles, gain), time_step, method="foh")
        numerator, denominator = scipy.signal.ss2tf(*system[:4])
        begin = values[..., :1] * scipy.signal.lfilter_zi(numerator[0], denominator)
        return np.asarray(scipy.signal.lfilter(numerator[0], denominator, values, zi=begin)[0])
