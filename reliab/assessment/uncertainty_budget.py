"""The budget of a test's uncertainty: sizes, what each contributes, and what would reduce it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from reliab.assessment.budget.sizes import PriorSource
from reliab.assessment.inference.uncertain_quantity import Description
from reliab.core.plain_values import PlainResult


@dataclass(frozen=True, kw_only=True)
class Widening:
    """Effect of one uncertain quantity on the interval."""

    name: str  # The tolerance, or "sensor_noise" or "initial_state"
    deviation: float  # Its standard deviation, relative or in SI units; zero for noise
    contribution: float  # Standard deviation of the error that it alone causes [-]
    width: float  # Width of the 90 % interval [-]
    width_without: float  # Width if this were known exactly [-]
    # Standard deviation at which the width is halved; None where no value does so alone
    deviation_for_half: float | None


@dataclass(frozen=True, kw_only=True)
class BudgetItem(PlainResult):
    """One quantity of the budget of a test's uncertainty."""

    name: str  # Key of what is not known exactly
    quantity: str  # The same in words
    size: float | None  # One standard deviation of it, in `unit`; None for noise, whose spectrum is estimated
    unit: str  # Unit of the size
    source: PriorSource  # Whether the size was stated, learned from the test, or is that of usual equipment
    contribution: float  # Standard deviation of the error that it alone causes [-]
    remedy: str  # What would reduce it, a sentence

    @classmethod
    def from_widening(cls, widening: Widening, description: Description, source: PriorSource) -> "BudgetItem":
        """Say in words what widens an interval."""
        return cls(
            name=widening.name,
            quantity=description.words,
            size=description.factor * widening.deviation if description.unit else None,
            unit=description.unit,
            source=source,
            contribution=widening.contribution,
            remedy=description.remedy,
        )


NOT_INFERRED: Final[Mapping[str, Description]] = {
    "specimen": Description(
        words="what the force shows of the specimen",
        unit="%",
        remedy="Repeat the test with less actuator error or a better force sensor, or calibrate a model "
        "of the specimen with `reliab diagnose`.",
    ),
    "sensor_noise": Description(
        words="noise of the displacement sensor", unit="", remedy="Use a displacement sensor with less noise."
    ),
}
"""What is drawn beside the quantities of a test."""
