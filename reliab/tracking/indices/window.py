"""Part of the record over which the error of a test is computed."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.motions.motion import arias_times


class _Kind(StrEnum):
    RECORD = "record"
    SECONDS = "seconds"
    ARIAS = "arias"


_SHORTEST = 1e-9  # s


@dataclass(frozen=True, kw_only=True)
class Window:
    """The whole record, its first seconds, or the part between 5 and 95 % of the Arias intensity.

    >>> Window.parse("40").label
    '40'
    >>> Window.parse("arias").label
    'arias'
    """

    kind: str = _Kind.RECORD  # The whole record by default, as in the paper
    # Length of the window from the record's first sample [s], for `kind` "seconds"; a shorter record is used
    # in full
    seconds: float = np.inf

    def __post_init__(self) -> None:
        if self.kind not in list(_Kind):
            raise InputError("Unknown window", value=self.kind, remedy=f"Choose among {', '.join(_Kind)}")
        if self.kind == _Kind.SECONDS and not (np.isfinite(self.seconds) and self.seconds >= _SHORTEST):
            raise InputError(
                f"The window's length must be at least {_SHORTEST:g} s, and finite",
                value=f"{self.seconds} s",
                remedy="Give the number of seconds from the record's first sample",
            )

    @classmethod
    def parse(cls, text: str) -> "Window":
        """Read "record", "arias" or a number of seconds."""
        if text in (_Kind.RECORD, _Kind.ARIAS):
            return cls(kind=text)
        try:
            seconds = float(text)
        except ValueError:
            raise InputError(
                "Unknown window",
                value=repr(text),
                remedy="Give 'record', 'arias' or a number of seconds",
            ) from None
        return cls(kind=_Kind.SECONDS, seconds=seconds)

    @property
    def label(self) -> str:
        """Text that `parse` turns back into this window."""
        return f"{self.seconds:g}" if self.kind == _Kind.SECONDS else str(self.kind)

    def bounds(self, acceleration: Array, time_step: float) -> tuple[float, float]:
        """Begin and end of the window on the record's time axis.

        `acceleration`: ground acceleration [m/s²], shape (n,); `time_step`: step between samples [s]. Returns
        begin and end [s].
        """
        duration = (acceleration.size - 1) * time_step
        if self.kind == _Kind.ARIAS:
            begin, end = arias_times(acceleration, time_step, (0.05, 0.95))
            return float(begin), float(end)
        return 0.0, min(duration, self.seconds)
