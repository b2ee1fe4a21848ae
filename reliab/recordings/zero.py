"""Where a structure rests on the scale of its command: at zero, or elsewhere, as on the stroke of a piston.

A linear structure oscillates about the position in which it rests. An error over a peak that is counted from
elsewhere would be too small.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from reliab.arrays import Array
from reliab.errors import InputError
from reliab.significant import significant
from reliab.vocabulary import MILLI

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from reliab.recordings.following import Rows

_LEAST = 0.02  # of the command's span: another zero below which nothing is said
_FROM_REST = 0.05  # of the largest step between samples: a first step of a command that begins at rest
_NEAR = 0.05  # of the span: distance of the mean from the first sample that may be motion
_SHARED = 0.5  # of another zero: distance between the means of two channels that share it
_PIECES, _STEADY = 8, 0.25  # of a command about another zero, and the scatter of their means over the mean


def zero_of(command: Array) -> float:
    """Value about which a command oscillates, shape (n,); 0 where that is zero, or cannot be told.

    >>> time = np.arange(0.0, 20.0, 0.01)
    >>> zero_of(0.1 + 0.003 * np.sin(time) ** 3), zero_of(np.cos(time))
    (0.1, 0.0)
    """
    motion = _begun(command)
    motion.goes_on(command)
    means = np.array([float(piece.mean()) for piece in np.array_split(command, _PIECES)])
    return motion.zero(steady=float(means.std()) < _STEADY * abs(motion.mean))


def rows_about_zero(rows: "Iterable[Rows]") -> "Iterator[Rows]":
    """Pass rows on; refuse them at their end where both channels oscillated about another value than zero.

    A loop that felt an offset of its sensor from before the first row moves the command alone.
    """
    motions: list[tuple[_Motion, _Motion]] = []
    for part in rows:
        channels = np.stack([np.atleast_2d(part.command), np.atleast_2d(part.measured)], axis=1)
        motions = motions or [(_begun(command), _begun(measured)) for command, measured in channels]
        for pair, histories in zip(motions, channels, strict=True):
            for motion, history in zip(pair, histories, strict=True):
                motion.goes_on(history)
        yield part
    for commanded, measured in motions:
        zero = commanded.zero()
        if zero and abs(measured.mean - commanded.mean) < _SHARED * abs(zero):
            raise InputError(
                "The channels of a test that is followed must count from the position in which the "
                "structure rests: over a peak that is counted from elsewhere its error is too small",
                value=f"a command that oscillates about {significant(MILLI * zero)} mm",
                remedy="State the reading of both channels at rest, as `zero` of a file `channels`, and "
                "follow the test again; `reliab assess` finds it by itself",
            )


@dataclass(kw_only=True)
class _Motion:
    """What a command did so far."""

    first: float
    low: float = np.inf
    high: float = -np.inf
    total: float = 0.0
    samples: int = 0
    first_step: float | None = None
    largest_step: float = 0.0

    @property
    def mean(self) -> float:
        """Mean of the samples so far [m]."""
        return self.total / self.samples

    def goes_on(self, command: Array) -> None:
        """Take further samples, shape (n,)."""
        steps = np.abs(np.diff(command))
        if self.first_step is None and steps.size:
            self.first_step = float(steps[0])
        self.largest_step = max(self.largest_step, float(steps.max(initial=0.0)))
        self.low, self.high = min(self.low, float(command.min())), max(self.high, float(command.max()))
        self.total += float(command.sum())
        self.samples += command.size

    def zero(self, *, steady: bool = False) -> float:
        """Value about which it oscillates; `steady` where parts of it have the same mean."""
        mean, span = self.mean, self.high - self.low
        if (self.first_step or 0.0) <= _FROM_REST * self.largest_step:
            oscillates = abs(mean - self.first) <= abs(self.first) / 2.0
            zero = self.first if abs(mean - self.first) <= _NEAR * span else mean
        else:
            oscillates = steady or self.low > 0.0 or self.high < 0.0
            zero = mean
        return zero if oscillates and abs(zero) > _LEAST * span else 0.0


def _begun(history: Array) -> _Motion:
    return _Motion(first=float(history[0]))
