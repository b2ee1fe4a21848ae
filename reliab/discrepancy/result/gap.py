"""The gap between model and measurement on held-out tests, and the error to expect on a further test."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from reliab.renamed import renamed_method

_FLOOR_UNCERTAINTY = 0.2
"""Relative uncertainty of a floor, which is estimated from the recordings: within it two sizes are one."""

_WHOLE = 0.999
"""Largest share of a gap that is said to be closed where what remains stands above the noise."""


class Remainder(StrEnum):
    """How what a model leaves on held-out tests compares with the noise floor."""

    AT_NOISE = "at the noise"
    ABOVE_NOISE = "above the noise"
    NOT_KNOWN = "noise not known"


@renamed_method("0.4", "as_dict", "to_dict")
@dataclass(frozen=True, kw_only=True)
class Gap:
    """Difference between model and measurement on held-out tests, before and after the effects are added.

    Attributes
    ----------
    held_out : tuple of str
        Files.
    channel : str
        Column.
    before, after : float
        RMS of the difference over RMS of the signal, calibrated model and model with the effects.
    floors : mapping of str to float
        RMS of the part that is not repeatable over RMS of the signal, by its source, the most reliable first;
        empty where the recordings do not show it. One above what the model leaves is no floor, and does not
        count.
    tests_before, tests_after : mapping of str to float
        `before` and `after` of each held-out test, by file.
    """

    held_out: tuple[str, ...]
    channel: str
    before: float
    after: float
    floors: Mapping[str, float]
    tests_before: Mapping[str, float]
    tests_after: Mapping[str, float]

    @property
    def source(self) -> str | None:
        """What the floor was taken from, None where it is not known."""
        possible = (
            name for name, size in self.floors.items() if size <= (1.0 + _FLOOR_UNCERTAINTY) * self.after
        )
        return next(possible, None)

    @property
    def floor(self) -> float | None:
        """RMS of what no model could explain over that of the signal, None where it is not known."""
        return None if self.source is None else self.floors[self.source]

    @property
    def remainder(self) -> Remainder:
        """Whether what remains is at the noise, within the uncertainty of the floor."""
        if self.floor is None:
            return Remainder.NOT_KNOWN
        at_noise = self.after <= (1.0 + _FLOOR_UNCERTAINTY) * self.floor
        return Remainder.AT_NOISE if at_noise else Remainder.ABOVE_NOISE

    @property
    def model_error(self) -> float:
        """What remains above the floor, RMS over that of the signal; all of it where no floor is known."""
        return float(np.sqrt(max(self.after**2 - (self.floor or 0.0) ** 2, 0.0)))

    @property
    def closed_fraction(self) -> float | None:
        """(before² − after²)/(before² − floor²) in [0, 1], None without a floor or a gap above it."""
        if self.floor is None or not self.before**2 > self.floor**2:
            return None
        share = (self.before**2 - self.after**2) / (self.before**2 - self.floor**2)
        return min(max(share, 0.0), 1.0)

    @property
    def stated_share(self) -> float | None:
        """Closed share of the gap as it is said: all of it only where what remains is at the noise.

        None where there was no gap above the noise.
        """
        if self.floor is None or self.before <= (1.0 + _FLOOR_UNCERTAINTY) * self.floor:
            return None
        if self.closed_fraction is None or self.remainder is Remainder.AT_NOISE:
            return self.closed_fraction
        return min(self.closed_fraction, _WHOLE)

    @property
    def unexplained_share(self) -> float:
        """Share of the gap's energy above the floor that remains with the effects, in [0, 1].

        Zero where nothing remains above the floor; one where the effects took nothing away.
        """
        remaining = self.model_error**2
        closed = max(self.before**2 - self.after**2, 0.0)
        return remaining / (remaining + closed) if remaining > 0.0 else 0.0

    def to_dict(self) -> dict[str, Any]:
        """Return the entry `gap`."""
        return {
            "held_out": list(self.held_out),
            "channel": self.channel,
            "nrmse_before": self.before,
            "nrmse_after": self.after,
            "noise_floor": self.floor,
            "noise_floor_source": self.source,
            "noise_floors": dict(self.floors),
            "model_error": self.model_error,
            "closed_fraction": self.closed_fraction,
            "tests": {
                file: {"nrmse_before": self.tests_before[file], "nrmse_after": self.tests_after[file]}
                for file in self.tests_after
            },
        }


@renamed_method("0.4", "as_dict", "to_dict")
@dataclass(frozen=True, kw_only=True)
class FurtherError:
    """Error to expect on a further test: RMS over that of the signal at the judged frequencies."""

    value: float  # value, low, high: Median and ends of the 90 % prediction interval
    low: float
    high: float
    tests: int  # Number of left-out tests that it rests on

    def to_dict(self) -> dict[str, Any]:
        """Return the entry `further_test`."""
        return {"value": self.value, "low": self.low, "high": self.high, "tests": self.tests}
