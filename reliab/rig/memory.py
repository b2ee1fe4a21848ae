"""What a rig's tests teach together: amplitude, delay, remainder and error, under given covariates."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.default_criterion import typical_ellipse
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import MILLI
from reliab.rig.covariates import Covariates, places_in_day, warmth
from reliab.rig.learned import FittedQuantity, learn
from reliab.rig.rig_folder import RigTable
from reliab.rig.watching import drift_chart
from reliab.structures.structure import Structure

FEWEST: Final = 3
MOST_TESTS: Final = 1000
"""Tests from which a rig is learned; of more, the latest."""

MEASURED_COVARIATES: Final = ("peak_mm", "velocity_mm_s", "f_eq_hz")
"""What every test has of itself, and a user may name as a covariate of the next one."""

_SMALLEST_REMAINDER = 1e-5
_DAY = 10  # characters of a date
_FEWEST_DATES = 3
_GROUPS = ("event", "day", "specimen", "changes")


@dataclass(frozen=True, kw_only=True)
class NextTest:
    """What is known of a test before it is performed."""

    date: str = ""  # By default after the last test
    specimen: str = ""  # By default that of the last test
    covariates: Mapping[str, float] | None = None
    peak: float | None = None  # Of the command [mm], where the motion is known


@dataclass(frozen=True, kw_only=True, eq=False)
class Memory:
    """Tests of one kind of structure, ready to be learned from."""

    table: RigTable

    @classmethod
    def from_table(cls, table: RigTable, frame: str = "") -> "Memory":
        """Take the tests of structures of one mass, or those of a frame; at least three."""
        required_columns = ("A", "d_ms", "remainder", "rms")
        sound = [
            place
            for place, row in enumerate(table.rows)
            if row["structure"] == frame and all(row[name] is not None for name in required_columns)
        ]
        if len(sound) < FEWEST:
            raise _too_few(table, frame, len(sound))
        return cls(table=table.only(sound[-MOST_TESTS:]))

    @cached_property
    def events(self) -> NDArray[np.str_]:
        """Earthquake of each test; a name of its own where it is not stated."""
        names = zip(self.table.texts("event"), self.table.texts("sha256"), strict=True)
        return np.array([event or f"test {sha}" for event, sha in names])

    @cached_property
    def is_ordered(self) -> bool:
        """Whether the order of the tests means something: dates are stated, and not all the same."""
        return self.table.has_dates and len(set(self.table.moments)) >= _FEWEST_DATES

    @cached_property
    def days(self) -> NDArray[np.str_]:
        """Day of each test; empty where it is not stated."""
        return np.array([date[:_DAY] for date in self.table.texts("date")])

    def covariates(self, coming: NextTest) -> Covariates:
        """Circumstances of the tests as far as they are known of the next one too."""
        numbers = {name: self.table.numbers(name) for name in coming.covariates or {}}
        for name, values in numbers.items():
            numbers[name] = _transform_covariate(name, values)
            if not np.isfinite(values).all():
                raise InputError(
                    "Not all tests of the rig have this `covariate`",
                    value=f"{name} of {int(np.isfinite(values).sum())} of {values.size}",
                    remedy="Leave it out",
                )
        if coming.peak is not None:
            numbers["peak_mm"] = _transform_covariate("peak_mm", self.table.numbers("peak_mm"))
        frequencies = self.table.numbers("f")
        if np.isfinite(frequencies).all():
            numbers["log f"] = np.log(frequencies)
        if self.is_ordered:
            numbers["warmth"] = warmth(places_in_day(self.days.tolist()))
        specimens = np.array(self.table.texts("specimen"))
        return Covariates(
            numbers=numbers,
            groups={
                "event": self.events,
                "day": self.days,
                "specimen": specimens,
                "changes": self._segments if self.is_ordered else np.full(len(self.table), ""),
            },
            place=np.arange(len(self.table), dtype=np.float64) if self.is_ordered else None,
        )

    def covariates_of(self, coming: NextTest, structure: Structure | None) -> Covariates:
        """Circumstances of the next test."""
        covariates = (coming.covariates or {}).items()
        numbers = {name: _transform_covariate(name, np.array([value])) for name, value in covariates}
        if coming.peak is not None:
            numbers["peak_mm"] = _transform_covariate("peak_mm", np.array([coming.peak]))
        if structure is not None:
            numbers["log f"] = np.array([np.log(structure.frequency)])
        last_day = str(self.days[-1])
        day = coming.date[:_DAY] or last_day
        if self.is_ordered:
            earlier = np.array(self.table.moments) < coming.date if coming.date else True
            numbers["warmth"] = warmth(np.array([float(((self.days == day) & earlier).sum())]))
        specimen = coming.specimen or self.table.texts("specimen")[-1]
        place = float(len(self.table))
        if coming.date and self.is_ordered:
            place = float(np.searchsorted(np.array(self.table.moments), coming.date, side="right")) - 0.5
        changes = str(self._segments[min(int(place + 0.5), len(self.table)) - 1]) if self.is_ordered else ""
        days = day if coming.date else ""
        groups = {"event": "", "day": days, "specimen": specimen, "changes": changes}
        return Covariates(
            numbers=numbers,
            groups={kind: np.array([groups[kind]]) for kind in _GROUPS},
            place=np.array([place]) if self.is_ordered else None,
        )

    def learn(self, values: Array, coming: NextTest) -> FittedQuantity:
        """Learn a quantity under the covariates that are known of the next test."""
        return learn(values, self.covariates(coming), self.events)

    @cached_property
    def _segments(self) -> NDArray[np.str_]:
        """How many changes of the rig had begun before each test, as a name."""
        return drift_chart(self.table.rows).segments.astype(str)

    @cached_property
    def amplitude(self) -> Array:
        """A of each test."""
        return self.table.numbers("A")

    @cached_property
    def delay(self) -> Array:
        """Equivalent delay of each test [ms]."""
        return self.table.numbers("d_ms")

    @cached_property
    def log_remainder(self) -> Array:
        """Logarithm of what is neither gain nor delay."""
        return np.log(np.maximum(self.table.numbers("remainder"), _SMALLEST_REMAINDER))

    @cached_property
    def log_error(self) -> Array:
        """Logarithm of the error of each test."""
        return np.log(np.maximum(self.table.numbers("rms"), 1e-12))

    @property
    def diverging(self) -> bool:
        """Whether most tests were later than a loop bears: a delay τ takes αAωτ off 2ξ (Horiuchi 1999)."""
        f, xi, alpha = (self.table.numbers(name) for name in ("f", "xi", "alpha"))
        dissipation = alpha * self.amplitude * 2.0 * np.pi * f * self.delay / MILLI
        return bool(np.median(dissipation - 2.0 * xi) > 0.0)

    def log_scale(self, structure: Structure) -> float:
        """Logarithm of the error that this rig's usual test has by the ellipse of a structure."""
        return float(np.log(self.explain_error(typical_ellipse(structure))))

    def log_scales(self) -> Array:
        """Return the same for the structure of each test."""
        rows = list(zip(*(self.table.numbers(name).tolist() for name in ("f", "xi", "alpha")), strict=True))
        scales = {
            (f, xi, alpha): self.log_scale(
                Structure(frequency=f, damping_ratio=xi, experimental_fraction=alpha)
            )
            for f, xi, alpha in set(rows)
        }
        return np.array([scales[row] for row in rows])

    def explain_error(self, ellipse: tuple[float, float]) -> float:
        """Error of this rig's usual test by the parameters of an ellipse, over the squared error."""
        return float(np.sqrt(sum(self.contributions(ellipse).values())))

    def contributions(self, ellipse: tuple[float, float]) -> dict[str, float]:
        """Share that each cause has in the squared error, in the mean over the tests."""
        a, b = ellipse
        return {
            "amplitude": float(np.median((self.amplitude - 1.0) ** 2)) / a,
            "delay": float(np.median(self.delay**2)) / b,
            "remainder": float(np.median(np.exp(2.0 * self.log_remainder))) / a,
        }


def _too_few(table: RigTable, frame: str, count: int) -> InputError:
    """Refuse fewer than three tests of a kind of structure; tests of others are named beside them."""
    kind = f"tests of the frame {frame!r}" if frame else "tests of single-degree-of-freedom structures"
    names = sorted({repr(row["structure"]) for row in table.rows if row["structure"] not in ("", frame)})
    other_text = f" in addition to those of {', '.join(names)}" if names else ""
    remedy = "Add tests with `reliab rig add`"
    if names and not frame:
        remedy += (
            ", or predict the next one of the frame with `reliab rig predict RIG --structure FRAME`; "
            "plans are for single-degree-of-freedom structures"
        )
    return InputError(
        f"Too few tests: a prediction needs {FEWEST} with a finite error",
        value=f"{count} {kind}{other_text}",
        remedy=remedy,
    )


def _transform_covariate(name: str, values: Array) -> Array:
    """Logarithms of what was measured, other covariates as they are."""
    return np.log(np.maximum(values, 1e-6)) if name in MEASURED_COVARIATES else values
