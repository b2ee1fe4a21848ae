"""An error of a test with the threshold it is judged by, of one interface displacement or of several."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np

from reliab.assessment.budget.sizes import PriorSource, limit_certainty
from reliab.assessment.parts import Parts
from reliab.assessment.rebuilt_error.spread import LEVEL, Estimate
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.assessment.recorded_ground import ShownGround
from reliab.assessment.uncertainty_budget import BudgetItem
from reliab.core.arrays import Array
from reliab.core.plain_values import Keys, PlainResult, same_names
from reliab.core.significant_digits import significant
from reliab.core.vocabulary import PERCENT, Metric
from reliab.structures.partition import Partition

if TYPE_CHECKING:
    from reliab.assessment.coupled_error import CoupledError, DegreeError
    from reliab.assessment.inferred_error import InferredError
    from reliab.assessment.measured_specimen.rebuild import MeasuredSpecimen
    from reliab.assessment.rebuild import RebuiltError
    from reliab.assessment.rebuilt_error.spread import DisplacementError


_PARTS: Final[Keys] = {"parts": "parts.by_name", "improve_first": "parts.first"}
_NO_PARTS: Final = Parts(gain=1.0, delay=0.0, by_name={}, rms=0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorWithThreshold(PlainResult, ABC):
    """Error of a test."""

    keys: ClassVar[Keys] = {
        **same_names("rms", "mte", "interval_level", "probability"),
        **_PARTS,
        "would_decide": "would_decide",
    }
    interval_level = LEVEL

    rebuilt: "RebuiltError | CoupledError"  # The error with its histories and draws
    metric: Metric  # Which error is asked about
    threshold: float  # Error with which it is compared [-]
    ground: ShownGround = ShownGround()  # noqa: RUF009 - What the recorded ground acceleration shows
    # What was learned of the specimen from its own force, where it is known by that only
    specimen: "MeasuredSpecimen | None" = None
    modelled: bool = False  # Whether a calibrated model says what the specimen does

    @property
    @abstractmethod
    def displacements(self) -> "tuple[DisplacementError, ...]":
        """Errors of the interface displacements, in their order."""

    @property
    def inferred(self) -> "InferredError | None":
        """What the channels show of everything that is uncertain; None where the specimen is not linear."""
        return None if self.modelled or self.specimen is not None else self.rebuilt.inferred

    @property
    def specimen_known(self) -> str:
        """How the specimen is known: "stated" as linear, "modelled" or "measured"."""
        if self.specimen is not None:
            return "measured"
        return "modelled" if self.modelled else "stated"

    def estimate(self, metric: Metric) -> Estimate:
        """Error by one metric, with its 90 % interval [-]; of several displacements the largest one."""
        return self.rebuilt.estimate(metric)

    @property
    def judged_estimate(self) -> Estimate:
        """Error that is compared with the threshold [-]."""
        return self.estimate(self.metric)

    @property
    def rms(self) -> Estimate:
        """RMS^R with its 90 % interval [-]."""
        return self.estimate(Metric.RMS)

    @property
    def mte(self) -> Estimate:
        """MTE^R with its 90 % interval [-]."""
        return self.estimate(Metric.MTE)

    @property
    def probability(self) -> float:
        """Probability that the error asked about stays below the threshold.

        Where sizes of what is unknown are assumed it is at most 0.99: rare sizes are not known so well.
        """
        return self._limit(self.rebuilt.probability(self.threshold, self.metric))

    def _limit(self, probability: float) -> float:
        return limit_certainty(probability, assumed=self.rebuilt.inferred.assumed)

    @property
    def displacement_suffix(self) -> str:
        """Of which displacement the error is, to follow its name; empty where there is one."""
        return ""

    @property
    def not_judged(self) -> tuple[str, ...]:
        """Why the errors of some displacements are not judged, in sentences."""
        return ()

    @property
    def largest_drawn(self) -> float:
        """Largest error asked about among the draws [-]."""
        return float(self.rebuilt.errors(self.metric).max())

    @property
    @abstractmethod
    def parts(self) -> Parts:
        """Parts of the error."""

    @property
    @abstractmethod
    def widenings(self) -> tuple[Widening, ...]:
        """What widens the interval, the widest first."""

    def exact_draws(self) -> Iterator[tuple[Partition, Array]]:
        """Draw structures, with their responses without actuator errors at swept samples [m], (p, m)."""
        return self.rebuilt.inferred.exact()

    @cached_property
    def budget(self) -> tuple[BudgetItem, ...]:
        """What makes the interval, the largest contribution first."""
        return self.rebuilt.inferred.budget(self.widenings)

    @property
    def would_decide(self) -> tuple[str, ...]:
        """What would narrow the interval most, in a sentence; none where nothing widens it."""
        if not self.widenings:
            return ()
        widest = self.widenings[0]
        item = next(item for item in self.budget if item.name == widest.name)
        if widest.deviation_for_half is None or item.unit != "%" or item.source is PriorSource.LEARNED:
            return (item.remedy,)
        half = significant(PERCENT * widest.deviation_for_half, 2)
        specimen_suffix = self._specimen_suffix
        return (
            f"Determine the {item.quantity} to {half} %: the interval{specimen_suffix} is then half as wide.",
        )

    @property
    def _specimen_suffix(self) -> str:
        """Of which specimen intervals hold without further ones, to follow "interval"."""
        return ""


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorOfSeveral(ErrorWithThreshold):
    """Error of a test with several interface displacements, of which the largest governs.

    Parameters and attributes are those of `ErrorWithThreshold`.
    """

    keys: ClassVar[Keys] = {
        "degrees_of_freedom": "degrees_of_freedom.{name}",
        "governing": "governing.name",
        **ErrorWithThreshold.keys,
    }

    rebuilt: "CoupledError"

    @property
    def displacements(self) -> "tuple[DegreeError, ...]":
        """Errors of the interface displacements, in their order."""
        return self.rebuilt.displacements

    @property
    def governing(self) -> "DegreeError | None":
        """The displacement with the largest error; None where all are lost in noise."""
        return self.rebuilt.governing(self.metric)

    @cached_property
    def widenings(self) -> tuple[Widening, ...]:
        """What widens the interval of the governing error, the widest first, if any is judged."""
        if self.governing is None:
            return ()
        return self.rebuilt.inferred.widenings(self.metric, self.displacements.index(self.governing))

    def probability_of(self, degree: "DegreeError") -> float:
        """Probability that the error of one displacement stays below the threshold."""
        return self._limit(degree.probability(self.threshold, self.metric))

    @cached_property
    def parts(self) -> Parts:
        """Parts of the error that governs; none where all are lost in noise."""
        if self.governing is None:
            gain, delay = self.rebuilt.tracking
            return Parts(gain=gain, delay=delay, by_name={}, rms=0.0)
        return self.parts_of(self.governing)

    def parts_of(self, degree: "DegreeError") -> Parts:
        """Parts of the error of one displacement."""
        parts = self.rebuilt.division.parts_of_degree(self.displacements.index(degree))
        return parts.subtract_noise(degree.rms.value)

    @property
    def displacement_suffix(self) -> str:
        """The displacement that governs, to follow the name of its error."""
        return "" if self.governing is None else f" of {self.governing.name}"

    @property
    def not_judged(self) -> tuple[str, ...]:
        """Why the errors of some displacements are not judged, in sentences."""
        return tuple(degree.refusal_reason for degree in self.displacements if not degree.judged)

    @property
    def degrees_of_freedom(self) -> "list[ErrorOfDegree]":
        """Errors of the interface displacements with their parts, the governing one first."""
        ordered_displacements = sorted(self.displacements, key=lambda degree: degree is not self.governing)
        return [
            ErrorOfDegree(
                name=degree.name,
                rms=degree.estimate(Metric.RMS),
                mte=degree.estimate(Metric.MTE),
                probability=self.probability_of(degree),
                parts=self.parts_of(degree),
            )
            if degree.judged
            else ErrorOfDegree(name=degree.name, why_not=degree.refusal_reason)
            for degree in ordered_displacements
        ]


UNKNOWN: Final = Estimate(value=np.nan, low=np.nan, high=np.nan)
"""An error that is not known."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorOfDegree(PlainResult):
    """Error of one of several interface displacements with its parts, or why it is not judged."""

    keys: ClassVar[Keys] = {
        "judged": "judged",
        "why_not?": "why_not",
        **same_names("rms", "mte", "probability"),
        **_PARTS,
    }

    name: str
    why_not: str = ""  # A sentence; empty for one that is judged
    rms: Estimate = UNKNOWN  # rms, mte: RMS^R and MTE^R with their 90 % intervals [-]
    mte: Estimate = UNKNOWN
    probability: float | None = None  # That the error asked about stays below the threshold
    parts: Parts = _NO_PARTS

    @property
    def judged(self) -> bool:
        """Whether the displacement moves enough for its noise."""
        return not self.why_not
