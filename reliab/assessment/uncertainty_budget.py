"""The budget of a test's uncertainty: sizes, what each contributes, and what would reduce it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from reliab.assessment.budget.sizes import PriorSource
from reliab.assessment.inference.uncertain_quantity import Description
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.core.plain_values import PlainResult


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
