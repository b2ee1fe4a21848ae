"""The budget of a test's uncertainty: sizes, what each contributes, and what would reduce it."""

from dataclasses import dataclass
from typing import Any, ClassVar, Final, Self

from reliab.assessment.budget.sizes import PriorSource
from reliab.assessment.inference.uncertain_quantity import Description
from reliab.core.plain_values import Keys, PlainResult, same_names


@dataclass(frozen=True, kw_only=True)
class BudgetItem(PlainResult):
    """One uncertain quantity, and what it does to the interval."""

    keys: ClassVar[Keys] = same_names("name", "quantity", "size", "unit", "source", "contribution", "remedy")

    name: str  # Key of what is not known exactly
    quantity: str  # The same in words
    deviation: float  # Its standard deviation, relative or in SI units; zero for noise
    size: float | None  # The same in `unit`; None for noise, whose spectrum is estimated
    unit: str  # Unit of the size
    source: PriorSource  # Whether the size was stated, learned from the test, or is that of usual equipment
    contribution: float  # Standard deviation of the error that it alone causes [-]
    width: float  # Width of the 90 % interval [-]
    width_without: float  # Width if this were known exactly [-]
    # Standard deviation at which the width is halved; None where no value does so alone
    deviation_for_half: float | None
    remedy: str  # What would reduce it, a sentence

    @classmethod
    def from_description(cls, description: Description, *, deviation: float, **values: Any) -> Self:  # noqa: ANN401
        """Say in words what widens an interval; `values`: of all other fields."""
        return cls(
            quantity=description.words,
            deviation=deviation,
            size=description.factor * deviation if description.unit else None,
            unit=description.unit,
            remedy=description.remedy,
            **values,
        )


SPECIMEN: Final = Description(
    words="what the force shows of the specimen",
    unit="%",
    remedy="Repeat the test with less actuator error or a better force sensor, or calibrate a model of the "
    "specimen with `reliab diagnose`.",
)
"""What is drawn of a learned specimen beside the quantities of a test."""

SENSOR_NOISE: Final = Description(
    words="noise of the displacement sensor", unit="", remedy="Use a displacement sensor with less noise."
)
"""What is drawn of the sensors beside the quantities of a test."""
