"""The budget of a test's uncertainty: sizes, what each contributes, and what would reduce it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from reliab.assessment.budget.sizes import PriorSource, Size
from reliab.assessment.inference.quantities import QUANTITIES, part_of_structure
from reliab.assessment.inference.uncertain_quantity import Description
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.core.plain_values import PlainResult
from reliab.structures.parts_of_structure import is_part


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


_NOT_INFERRED = {  # with a measured specimen, or where the noise of its sensor is drawn
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
_DESCRIPTIONS: Mapping[str, Description] = {
    **{quantity.name: quantity for quantity in QUANTITIES},
    **_NOT_INFERRED,
}


def budget_of_error(widenings: Iterable[Widening], sizes: Mapping[str, Size]) -> tuple[BudgetItem, ...]:
    """List what makes the interval of an error, the largest contribution first."""
    return tuple(_item(widening, sizes) for widening in widenings)


def _item(widening: Widening, sizes: Mapping[str, Size]) -> BudgetItem:
    """Describe a quantity of the test, or of one of its actuators, and what it contributes."""
    name = widening.name
    begin, _, number = name.rpartition("_")
    stem = begin if number.isdecimal() and not is_part(name) else name
    description = describe(stem)
    if stem != name:
        description = description.describe_for_actuator(int(number))
    size = sizes.get(name, sizes.get(stem))
    return BudgetItem.from_widening(
        widening, description, PriorSource.LEARNED if size is None else size.source
    )


def describe(name: str) -> Description:
    """Describe what is not known exactly, such as "time_shift" or "storey_stiffness_2"."""
    return part_of_structure(name) if is_part(name) else _DESCRIPTIONS[name.removeprefix("lagging_")]
