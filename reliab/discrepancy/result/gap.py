"""The gap between model and measurement on held-out tests, and the error to expect on a further test."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar, Final

import numpy as np

from reliab.core.plain_values import Keys, PlainResult, same_names
from reliab.core.significant_digits import percent

_FLOOR_UNCERTAINTY = 0.2
"""Relative uncertainty of a floor, which is estimated from the recordings: within it two sizes are one."""

FLOOR_EXCESS = 2.0
"""Times the noise floor from which a remainder is called an effect: three quarters of its energy are then no
noise."""

NO_CHANGE = 0.02
"""Change of the error on held-out tests, over the error, below which an effect changes nothing."""

_ERRORS: Final[Keys] = {
    "nrmse_before": "before",
    "nrmse_after": "after",
    "unexplained_share": "unexplained_share",
}
_MOST_CLOSED = 0.999
"""Largest share of a gap that is said to be closed where what remains stands above the noise."""


class Remainder(StrEnum):
    """How what a model leaves on held-out tests compares with the noise floor."""

    AT_NOISE = "at the noise"
    ABOVE_NOISE = "above the noise"
    NOT_KNOWN = "noise not known"


@dataclass(frozen=True, kw_only=True)
class HeldOutTest:
    """Errors in one held-out test, RMS of the difference over RMS of its signal."""

    file: str
    kind: str = ""  # Of its motion ("sine")
    before: float  # before, after: Calibrated model and model with the effects
    after: float
    size: float = 1.0  # RMS of its signal over that of all of them
    # Whether what the model with the effects leaves is spread over time and frequency as noise is: it is
    # taken for noise, unless a known floor is far below it
    noise_like: bool = False


@dataclass(frozen=True, kw_only=True)
class Gap(PlainResult):
    """Difference between model and measurement on held-out tests, before and after the effects are added."""

    keys: ClassVar[Keys] = {
        **same_names("held_out", "channel"),
        "nrmse_before": "before",
        "nrmse_linear": "error_of_linear",
        "nrmse_after": "after",
        "nrmse_rival": "rival",
        "rival_effects": "rival_effects",
        "noise_floor": "floor",
        "noise_floor_source": "source",
        "noise_floors": "floors",
        **same_names("model_error", "closed_fraction", "conclusion"),
        "tests": ("by_test.{file}", {"kind": "kind", **_ERRORS}),
        "kinds": ("by_kind", {"kind": "kind", "tests": "files", **_ERRORS}),
    }

    channel: str  # Column
    # before, after: RMS of the difference over RMS of the signal, calibrated model and model with the effects
    before: float
    after: float
    # RMS of the part that is not repeatable over RMS of the signal, by its source, the most reliable first;
    # empty where the recordings do not show it. One above what the model leaves is no floor, and does not
    # count
    floors: Mapping[str, float]
    tests: tuple[HeldOutTest, ...]
    missing: bool = True  # Whether anything was found to be missing, so that there is a gap to explain
    # The same size for the best linear model, whatever was stated; as `before` unless given
    linear: float | None = None
    rival: float | None = None  # The same size for the best model that lacks one of the effects
    rival_effects: tuple[str, ...] = ()  # Effects of that model

    @property
    def held_out(self) -> tuple[str, ...]:
        """Files of the held-out tests."""
        return tuple(test.file for test in self.tests)

    @property
    def error_of_linear(self) -> float:
        """RMS of the difference over that of the signal for the best linear model."""
        return self.before if self.linear is None else self.linear

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
        """Whether what remains is at the level of the noise, within the uncertainty of the floor."""
        if self.floor is None:
            return Remainder.NOT_KNOWN
        is_noise = self.after <= (1.0 + _FLOOR_UNCERTAINTY) * self.floor
        return Remainder.AT_NOISE if is_noise else Remainder.ABOVE_NOISE

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
    def looks_like_noise(self) -> bool:
        """Whether what the model with the effects leaves is spread as noise is in every held-out test."""
        return all(test.noise_like for test in self.tests)

    @property
    def is_noise_before(self) -> bool:
        """Whether the calibrated model leaves noise alone, so that there is nothing to explain."""
        if self.floor is not None:
            return self.before <= (1.0 + _FLOOR_UNCERTAINTY) * self.floor
        return self.looks_like_noise and self.before <= (1.0 + _FLOOR_UNCERTAINTY) * self.after

    @property
    def stated_share(self) -> float | None:
        """Closed share of the gap as it is said: all of it only where what remains is at the noise.

        None where no floor is known, or where there was no gap above it.
        """
        if self.floor is None or self.unexplained_share is None:
            return None
        share = 1.0 - self.unexplained_share
        return share if self.remainder is Remainder.AT_NOISE else min(share, _MOST_CLOSED)

    @property
    def unexplained_share(self) -> float | None:
        """Share of the gap's energy above the floor that remains with the effects, in [0, 1].

        Zero where what remains is at the noise, one where the effects took nothing away, None where nothing
        is missing or the calibrated model is at the noise: there is nothing to explain.
        """
        if self.is_noise_before or not self.missing:
            return None
        noise = self.after if self.remainder is Remainder.AT_NOISE else self.floor or 0.0
        return _remaining_share(self.before, self.after, noise)

    @property
    def conclusion(self) -> str:
        """What the sizes mean, a clause that is the same on the screen, in the JSON and in the report."""
        if self.is_noise_before and not (self.missing and self.after < (1.0 - NO_CHANGE) * self.before):
            what = "these tests cannot show the effect" if self.missing else "there is nothing to explain"
            return f"the error of the calibrated model is at the level of the noise: {what}"
        if not self.missing:
            cause = "above the noise" if self.floor is not None else "of unknown cause"
            return f"the error is {cause}, but too small to be called an effect"
        share = "" if self.stated_share is None else percent(self.stated_share, decimals=1)
        match self.remainder:
            case Remainder.AT_NOISE:
                return "what remains is at the level of the noise"
            case Remainder.ABOVE_NOISE:
                return f"{share} of the gap closed, and what remains is an error of the model"
            case Remainder.NOT_KNOWN if self.looks_like_noise:
                return "what remains looks like noise, whose size the recordings do not show"
            case Remainder.NOT_KNOWN:
                return "how much of what remains is noise is not known"

    @property
    def worst_unexplained_share(self) -> float | None:
        """Unexplained share of the kind of test of which least is explained, None as for all tests."""
        shares = [gap.unexplained_share for gap in self.by_kind if gap.unexplained_share is not None]
        return max(shares, default=None)

    @property
    def by_kind(self) -> tuple["GapOfKind", ...]:
        """The gap in each kind of held-out test, the least explained first."""
        return self._gaps_by(lambda test: test.kind)

    @property
    def by_test(self) -> tuple["GapOfKind", ...]:
        """The gap in each held-out test, the least explained first."""
        return self._gaps_by(lambda test: test.file)

    def _gaps_by(self, key: Callable[[HeldOutTest], str]) -> tuple["GapOfKind", ...]:
        """Compare errors over the tests of each key, which count alike."""
        groups: dict[str, list[HeldOutTest]] = {}
        for test in self.tests:
            groups.setdefault(key(test), []).append(test)
        gaps = []
        for tests in groups.values():
            squares = np.square([(test.before, test.after, self._noise_in(test)) for test in tests])
            before, after, noise = np.sqrt(np.mean(squares, axis=0)).tolist()
            files = tuple(test.file for test in tests)
            errors = {"before": before, "after": after, "noise": noise}
            gaps.append(GapOfKind(kind=tests[0].kind, files=files, missing=self.missing, **errors))
        return tuple(sorted(gaps, key=lambda gap: (-(gap.unexplained_share or 0.0), -gap.after)))

    def _noise_in(self, test: HeldOutTest) -> float:
        """RMS of the noise in a test over that of its signal; in a weak one a floor is a larger share.

        What is spread as noise may be above a floor: noise of the motion adds to that of the channel.
        """
        if self.floor is None:
            return test.after if test.noise_like else 0.0
        floor = self.floor / max(test.size, 1e-300)
        excess = FLOOR_EXCESS if test.noise_like else 1.0 + _FLOOR_UNCERTAINTY
        return test.after if test.after <= excess * floor else floor


@dataclass(frozen=True, kw_only=True)
class GapOfKind:
    """Gap in the held-out tests of one kind, or in one of them: RMS of each over that of its signal."""

    kind: str  # Of motion
    files: tuple[str, ...]  # The tests
    before: float  # before, after: Error of the calibrated model, and with the effects
    after: float
    noise: float  # What no model could explain, zero where it is not known
    missing: bool  # Whether anything was found to be missing

    @property
    def file(self) -> str:
        """The first of the tests."""
        return self.files[0]

    @property
    def unexplained_share(self) -> float | None:
        """Share of the gap's energy above the noise that remains with the effects, in [0, 1].

        None where nothing is missing or the calibrated model is at the noise: there is nothing to explain.
        """
        if not self.missing or (self.noise > 0.0 and self.before <= (1.0 + _FLOOR_UNCERTAINTY) * self.noise):
            return None
        return _remaining_share(self.before, self.after, self.noise)


def _remaining_share(before: float, after: float, noise: float) -> float:
    """Share of a gap's energy above a noise that remains after effects are added."""
    remaining, closed_energy = max(after**2 - noise**2, 0.0), max(before**2 - after**2, 0.0)
    return remaining / (remaining + closed_energy) if remaining > 0.0 else 0.0


@dataclass(frozen=True, kw_only=True)
class FurtherError(PlainResult):
    """Error to expect on a further test: RMS over that of the signal at the judged frequencies."""

    value: float  # value, low, high: Median and ends of the 90 % prediction interval
    low: float
    high: float
    tests: int  # Number of left-out tests that it rests on
