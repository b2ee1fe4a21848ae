"""One ground motion: an acceleration record at equal time steps; changes of its rate and length."""

import hashlib
import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.physical_range import require_physical
from reliab.core.vocabulary import STANDARD_GRAVITY

MOST_SAMPLES = 2_000_000
"""Largest number of samples of a motion; its simulation then takes about 1.5 GB on each processor."""

PEAK_LIMIT_G = 5.0
"""Largest peak accepted [g]; the strongest record so far has about 4 g, a larger one means wrong units."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """One component of ground acceleration, sampled at equal steps and linear in between.

    Two motions are equal when their names, events, sets and checksums are.

    Parameters
    ----------
    name : str
        Unique name within a suite, for example ``"KOBE/NIS000"``.
    acceleration : array of float, shape (n,)
        Ground acceleration [m/s²], finite, 2 ≤ n ≤ 2 million, peak at most 5 g. It is copied and
        made read-only.
    time_step : float
        Interval between samples [s], positive.
    event : str, optional
        The earthquake; if empty, the motion counts as a separate event with the motion's name.
    set_name : str, optional
        The set of a catalogue that the motion belongs to.

    Raises
    ------
    InputError
        If the samples or the step break one of the rules above.

    Examples
    --------
    >>> motion = Motion(name="pulse", acceleration=[0.0, 2.0, 0.0], time_step=0.5)
    >>> motion.duration, motion.peak_acceleration, motion.event
    (1.0, 2.0, 'pulse')
    """

    name: str
    acceleration: Array
    time_step: float
    event: str = ""
    set_name: str = ""

    def __post_init__(self) -> None:
        if not self.name:
            raise InputError("A motion must have a name", remedy="Name it, by its record for example")
        require_short(np.size(self.acceleration), self.name)
        object.__setattr__(self, "acceleration", _check_samples(self.acceleration, self.name))
        require_physical("time step", self.time_step, where=self.name)
        object.__setattr__(self, "time_step", float(self.time_step))
        object.__setattr__(self, "event", self.event or self.name)

    def load(self) -> "Motion":
        """Return the motion itself, which is an entry of a suite that needs no reading."""
        return self

    @property
    def duration(self) -> float:
        """Time between the first and the last sample [s]."""
        return (self.acceleration.size - 1) * self.time_step

    @cached_property
    def peak_acceleration(self) -> float:
        """Largest absolute acceleration [m/s²]."""
        return float(np.abs(self.acceleration).max())

    @property
    def times(self) -> Array:
        """Times of the samples, from zero [s], shape (n,)."""
        return np.arange(self.acceleration.size, dtype=np.float64) * self.time_step

    @cached_property
    def checksum(self) -> str:
        """SHA-256 of the step and the samples as little-endian doubles, the same on every platform."""
        digest = hashlib.sha256(np.float64(self.time_step).astype("<f8").tobytes())
        digest.update(self.acceleration.astype("<f8").tobytes())
        return digest.hexdigest()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Motion):
            return NotImplemented
        return self._identity() == other._identity()

    def __hash__(self) -> int:
        return hash(self._identity())

    def _identity(self) -> tuple[str, str, str, str]:
        return self.name, self.event, self.set_name, self.checksum


def require_short(samples: int, name: str) -> None:
    """Refuse a motion whose simulation would not fit in memory.

    >>> require_short(10_000_000, "long")
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: long: Too many samples, above 2,000,000; found 10,000,000. Keep the
    strong part of the record, or resample it.
    """
    if samples > MOST_SAMPLES:
        raise InputError(
            f"Too many samples, above {MOST_SAMPLES:,}",
            value=f"{samples:,}",
            remedy="Keep the strong part of the record, or resample it",
            where=name,
        )


def _check_samples(samples: Array, name: str) -> Array:
    samples_copy = np.array(samples, dtype=np.float64)
    if samples_copy.ndim != 1 or samples_copy.size < 2:  # noqa: PLR2004 - two samples make the shortest record
        raise InputError(
            "A motion must be a one-dimensional array of at least two samples",
            value=f"shape {samples_copy.shape}",
            where=name,
            remedy="Give the accelerations of one component",
        )
    if not np.isfinite(samples_copy).all():
        first = int(np.flatnonzero(~np.isfinite(samples_copy))[0])
        raise InputError(
            "Not a finite number",
            value=f"{samples_copy[first]} at sample {first}",
            remedy="Repair or leave out the record",
            where=name,
        )
    peak = float(np.abs(samples_copy).max()) / STANDARD_GRAVITY
    if peak > PEAK_LIMIT_G:
        raise InputError(
            f"Implausible peak, above {PEAK_LIMIT_G:g} g",
            value=f"{peak:.4g} g",
            remedy="Check the units; a motion is in m/s²",
            where=name,
        )
    samples_copy.flags.writeable = False
    return samples_copy


_STEP_TOLERANCE = 1e-9  # a fraction of a step below which a time counts as lying on a sample


def resample(motion: Motion, rate_hz: float = 1024.0) -> Motion:
    """Interpolate a motion linearly at another rate.

    The paper interpolates every record to 1024 Hz. Linear interpolation changes nothing between the
    samples of a rate above the record's own, but a lower rate drops what lies between its samples.

    `motion`: the record, n samples at its own step; `rate_hz`: new sampling rate [Hz], positive. Returns
    samples at k / rate_hz for every k that lies within the record; at most one new step shorter. Raises
    InputError if the rate is not positive or leaves fewer than two samples.

    >>> slow = Motion(name="ramp", acceleration=[0.0, 1.0, 0.0], time_step=0.5)
    >>> resample(slow, rate_hz=4.0).acceleration.tolist()
    [0.0, 0.5, 1.0, 0.5, 0.0]
    """
    require_physical("sampling rate", rate_hz)
    steps = math.floor(motion.duration * rate_hz + _STEP_TOLERANCE)
    if steps < 1:
        raise InputError(
            "At this sampling rate fewer than two samples are left",
            value=f"{rate_hz} Hz over {motion.duration} s",
            where=motion.name,
            remedy="Choose a higher rate",
        )
    times = np.arange(steps + 1) / rate_hz
    samples = np.interp(times, motion.times, motion.acceleration)
    return replace(motion, acceleration=samples, time_step=1.0 / rate_hz)


_CORNER = 4.0  # Hz, above which filters and time steps of two versions of a record differ
_SAMPLING_SHARE = 0.4  # the same as a share of the sampling rate, for long steps
_REACH = 3.0  # s, on either side of the strongest swing
_POINTS = 151
_BITS = 256
_MOST_DIFFERENT_BITS = (
    36  # bits that may differ in a copy; the most alike of 200 unrelated records differ in 46
)


def outline_of(motion: Motion) -> str:
    """Describe the strongest swing of a record in 64 hexadecimal digits, whatever its scale and length.

    >>> t = np.arange(0.0, 30.0, 0.01)
    >>> record = np.sin(t**1.5) * np.exp(-(((t - 12.0) / 4.0) ** 2))
    >>> motion, copy = (
    ...     Motion(name=name, acceleration=values, time_step=0.01)
    ...     for name, values in (("record", record), ("copy", -1.7 * record[500:2300]))
    ... )
    >>> are_copies([outline_of(motion)], [outline_of(copy)]).tolist()
    [[True]]
    """
    rate = 1.0 / motion.time_step
    low_pass = scipy.signal.butter(2, min(_CORNER, _SAMPLING_SHARE * rate), fs=rate, output="sos")
    swings = scipy.signal.sosfilt(low_pass, motion.acceleration)
    times = motion.time_step * np.arange(swings.size)
    place = int(np.abs(swings).argmax())
    around = times[place] + np.linspace(-_REACH, _REACH, _POINTS)
    stretch = np.interp(around, times, swings, left=0.0, right=0.0) * np.sign(swings[place])
    return np.packbits(_patterns() @ stretch > 0.0).tobytes().hex()


def are_copies(outlines: Iterable[str], other_outlines: Iterable[str]) -> NDArray[np.bool_]:
    """Whether records are copies of others by their outlines, shape (records, others)."""
    signs, others_signs = (
        np.array([2.0 * np.unpackbits(np.frombuffer(bytes.fromhex(text), np.uint8)) - 1.0 for text in texts])
        for texts in (outlines, other_outlines)
    )
    return np.asarray(0.5 * (_BITS - signs @ others_signs.T) <= _MOST_DIFFERENT_BITS)


@cache
def _patterns() -> Array:
    """Patterns without likeness to each other, the same on every machine, shape (bits, points)."""
    number, place = np.arange(1, _BITS + 1)[:, None], np.arange(1, _POINTS + 1)[None, :]
    return np.asarray(np.cos(np.pi * np.sqrt(number + 1.0) * place**2))
