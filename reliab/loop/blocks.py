"""The record divided into equal blocks of time whose length depends on the structure only.

A stepping engine advances in equal blocks. In each block the record a_g is replaced by the straight
line, from a₀ to a₁, that has exactly the same effect on the structure's own mode z' = pz + a_g::

    F₀a₀ + F₁a₁ = z(t + H) − e^(pH)z(t),   F₁ = ∫₀ᴴ (s/H)e^(p(H−s)) ds,   F₀ = ∫₀ᴴ e^(p(H−s)) ds − F₁

(two real numbers for one complex one). A mode whose pole lies near p, as it does for a small actuator error,
then responds to the line nearly as to the record. The exact response x_I follows from the same z.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from reliab.compiled import compiled
from reliab.loop.excitation import Excitation
from reliab.loop.structure import Structure

LARGEST_PHASE_STEP = 0.09
"""Largest ω₀H of a block [rad]. The sampled peak of a harmonic is then within 1e-3 of the true one; for any
record the peak of the parabola through three samples is."""

LONGEST_BLOCK = 0.01
"""Longest block [s], so that the response of a soft structure above its own frequency is resolved too."""

_AT_SAMPLE = 1e-9  # of the record's step; a time closer than this to a sample counts as that sample's
_NEAR_PEAK = 0.97  # a block that ends this high may hold the peak of the exact response
_PARTS = 16  # into which such a block is divided

_Number = TypeVar("_Number", np.float64, np.complex128)


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """A record as straight lines over equal blocks of time, and the exact response at their edges.

    Attributes
    ----------
    step : float
        Length H of a block [s].
    before : int
        Blocks before the window.
    end : float
        Fraction of the last block at which the window ends, in (0, 1].
    left, right : numpy.ndarray
        Ground acceleration [m/s²] at the two ends of each block, shape (blocks,).
    ideal : numpy.ndarray
        Exact response x_I [m] at the edges of the blocks, shape (blocks + 1,).
    excitation : Excitation
        The record and its window.
    pole : complex
        Pole p of the structure's own mode [1/s].
    """

    step: float
    before: int
    end: float
    left: NDArray[np.float64]
    right: NDArray[np.float64]
    ideal: NDArray[np.float64]
    excitation: Excitation
    pole: complex

    @property
    def intervals(self) -> float:
        """Length of the window in blocks."""
        return self.left.size - self.before - 1 + self.end

    @property
    def most_ahead(self) -> int:
        """Largest number of blocks that an actuator can look ahead: those in a quarter of the period."""
        return int(np.ceil(0.5 * np.pi / (abs(self.pole) * self.step))) + 1

    def prolonged(self, count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Ground acceleration at the ends of the blocks and of further ones after the window.

        Parameters
        ----------
        count : int
            Further blocks, at most as many as a lead of a quarter of the period needs.

        Returns
        -------
        left, right : numpy.ndarray
            Ground acceleration [m/s²], shape (blocks + count,); zero after the record.
        """
        if count == 0:
            return self.left, self.right
        total = self.left.size + count
        return self._longest_lines[0][:total], self._longest_lines[1][:total]

    @cached_property
    def _longest_lines(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        count = self.left.size - self.before + self.most_ahead
        begin = self.excitation.window[0]
        edges = begin + self.step * np.arange(-self.before, count + 1, dtype=np.float64)
        silence = np.zeros(int(np.ceil((count + 1) * self.step / self.excitation.time_step)) + 2)
        record = np.concatenate([self.excitation.acceleration, silence])
        followed = Excitation(acceleration=record, time_step=self.excitation.time_step)
        return _lines(_mode(followed, self.pole, edges), self.pole, self.step)

    @cached_property
    def ideal_peak(self) -> float:
        """Largest |x_I| [m] inside the window, between the edges of blocks too."""
        begin, end = self.excitation.window
        inside = np.abs(self.ideal[self.before :])
        high = inside >= _NEAR_PEAK * inside.max()
        starts = begin + self.step * np.flatnonzero(high[1:] | high[:-1])
        close = np.add.outer(starts, self.step * np.linspace(0.0, 1.0, _PARTS + 1)).ravel()
        mode = _mode(self.excitation, self.pole, np.minimum(close, end))
        return float(np.abs(mode.imag).max() / self.pole.imag)


def ramp_weights(
    pole: NDArray[_Number], step: float
) -> tuple[NDArray[_Number], NDArray[_Number], NDArray[_Number]]:
    """Weights F₀, F₁ and decay e^(pH) of the mode z' = pz + a over a block in which a is linear."""
    phase = pole * step
    whole = np.expm1(phase) / pole
    late = (whole - step) / phase
    return whole - late, late, np.exp(phase)


def block_length(structure: Structure) -> float:
    """Length of a block [s] that suits the structure."""
    return min(LONGEST_BLOCK, LARGEST_PHASE_STEP / structure.circular_frequency)


def cut(excitation: Excitation, structure: Structure, *, step: float | None = None) -> Blocks:
    """Cut a record into equal blocks, one of which starts where the window starts.

    Parameters
    ----------
    excitation : Excitation
        Record and window.
    structure : Structure
        The structure whose mode the blocks preserve.
    step : float, optional
        Length of a block [s]; by default one that suits the structure.

    Returns
    -------
    Blocks
        The record as one straight line a block, with the exact response.
    """
    begin, end = excitation.window
    step = min(step or block_length(structure), 0.5 * (end - begin))
    inside = int(np.ceil((end - begin) / step - 1e-9))
    before = int(np.ceil(begin / step - 1e-9))
    edges = begin + step * np.arange(-before, inside + 1, dtype=np.float64)
    pole = structure.pole
    mode = _mode(excitation, pole, edges)
    left, right = _lines(mode, pole, step)
    return Blocks(
        step=step,
        before=before,
        end=(end - begin) / step - (inside - 1),
        left=left,
        right=right,
        ideal=-mode.imag / pole.imag,  # x_I = −2Re(z/(p − p̄))
        excitation=excitation,
        pole=pole,
    )


@lru_cache(maxsize=4096)
def _weights(pole: complex, step: float) -> tuple[complex, complex, complex]:
    """Weights and decay of one mode, as `ramp_weights`."""
    early, late, decay = (complex(weight[0]) for weight in ramp_weights(np.array([pole]), step))
    return early, late, decay


def _lines(
    mode: NDArray[np.complex128], pole: complex, step: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Straight lines that drive the mode from edge to edge: their values at both ends of each block."""
    return _drive_mode(mode, *_weights(pole, step))


@compiled
def _drive_mode(
    mode: NDArray[np.complex128], early: complex, late: complex, decay: complex
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Solve both parts of F₀a₀ + F₁a₁ for each block; in real numbers, which compilers turn into less."""
    left, right = np.empty(mode.size - 1), np.empty(mode.size - 1)
    determinant = early.real * late.imag - early.imag * late.real
    for i in range(left.size):
        x, y = mode[i].real, mode[i].imag
        u = mode[i + 1].real - (decay.real * x - decay.imag * y)
        v = mode[i + 1].imag - (decay.real * y + decay.imag * x)
        left[i] = (late.imag * u - late.real * v) / determinant
        right[i] = (early.real * v - early.imag * u) / determinant
    return left, right


def _mode(excitation: Excitation, pole: complex, times: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Exact z of the mode z' = pz + a_g at given times, zero before the record starts."""
    h = excitation.time_step
    return _step_mode(excitation.acceleration, h, pole, _weights(pole, h), times)


@compiled
def _step_mode(
    a: NDArray[np.float64],
    h: float,
    pole: complex,
    weights: tuple[complex, complex, complex],
    times: NDArray[np.float64],
) -> NDArray[np.complex128]:
    early, late, decay = weights
    at_samples = np.zeros(a.size, dtype=np.complex128)
    for i in range(a.size - 1):
        at_samples[i + 1] = decay * at_samples[i] + early * a[i] + late * a[i + 1]
    z = np.zeros(times.size, dtype=np.complex128)
    for k in range(times.size):
        if times[k] > 0.0:
            i = min(int(times[k] / h + 1e-9), a.size - 2)
            into = times[k] - i * h
            if into < _AT_SAMPLE * h:
                z[k] = at_samples[i]
                continue
            # z(t + s) = e^(ps)z + a(e^(ps) − 1)/p + a'(e^(ps) − 1 − ps)/p²
            grown = np.exp(pole * into)
            held = (grown - 1.0) / pole
            z[k] = grown * at_samples[i] + a[i] * held + (a[i + 1] - a[i]) / h * (held - into) / pole
    return z
