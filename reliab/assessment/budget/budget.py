"""The budget of a test's uncertainty: sizes, what each contributes, and what would reduce it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from reliab.assessment.budget.sizes import Size, Source
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.structures import PARTS, is_part, part_and_number
from reliab.vocabulary import MILLI, PERCENT


@dataclass(frozen=True, kw_only=True)
class BudgetItem:
    """One quantity of the budget of a test's uncertainty.

    Attributes
    ----------
    name : str
        Key of what is not known exactly.
    quantity : str
        The same in words.
    size : float or None
        One standard deviation of it, in `unit`; None for noise, whose spectrum is estimated.
    unit : str
        Unit of the size.
    source : Source
        Whether the size was stated, learned from the test, or is that of ordinary equipment.
    contribution : float
        Standard deviation of the error that it alone causes [-].
    remedy : str
        What would reduce it, a sentence.
    """

    name: str
    quantity: str
    size: float | None
    unit: str
    source: Source
    contribution: float
    remedy: str

    def to_dict(self) -> dict[str, Any]:
        """Put it into plain values."""
        return {**vars(self), "source": str(self.source)}


@dataclass(frozen=True, kw_only=True)
class _Quantity:
    name: str
    unit: str
    factor: float  # From the unit in which it is drawn to that of the budget
    remedy: str


_QUANTITIES = {
    "frequency": _Quantity(
        name="natural frequency",
        unit="%",
        factor=PERCENT,
        remedy="Measure the natural frequency by a free vibration, and state its deviation.",
    ),
    "damping_ratio": _Quantity(
        name="damping ratio",
        unit="%",
        factor=PERCENT,
        remedy="Measure the damping ratio by a free vibration, and state its deviation.",
    ),
    "experimental_fraction": _Quantity(
        name="share of the stiffness",
        unit="%",
        factor=PERCENT,
        remedy="Measure the specimen's stiffness, and state the deviation of its share.",
    ),
    "sensor_scale": _Quantity(
        name="scale of the displacement sensor",
        unit="%",
        factor=PERCENT,
        remedy="Calibrate the displacement sensor against the command, and state its scale.",
    ),
    "sensor_offset": _Quantity(
        name="offset of the displacement sensor",
        unit="mm",
        factor=MILLI,
        remedy="Record some seconds of rest before the test, which show the sensor's offset.",
    ),
    "time_shift": _Quantity(
        name="skew of the channels",
        unit="ms",
        factor=MILLI,
        remedy="Measure the skew, by one signal on both channels, and state it.",
    ),
    "feedback_lag": _Quantity(
        name="lag of the fed-back force",
        unit="ms",
        factor=MILLI,
        remedy="Measure by how much the force is fed back late, and state it.",
    ),
    "filter_delay": _Quantity(
        name="filters of the channels",
        unit="ms",
        factor=MILLI,
        remedy="State the filters of both channels, or use the same on both.",
    ),
    "hysteresis": _Quantity(
        name="hysteresis of the displacement sensor",
        unit="%",
        factor=PERCENT,
        remedy="Measure the sensor's hysteresis by a slow cycle, and state it.",
    ),
    "lagging_hysteresis": _Quantity(
        name="hysteresis of the displacement sensor",
        unit="%",
        factor=PERCENT,
        remedy="Measure the sensor's hysteresis by a slow cycle, and state it.",
    ),
    "sensor_drift": _Quantity(
        name="drift of the displacement sensor",
        unit="mm",
        factor=MILLI,
        remedy="Record rest before and after the test, which shows the sensor's drift.",
    ),
    "open_offset": _Quantity(
        name="whether the loop felt the sensor's offset",
        unit="mm",
        factor=MILLI,
        remedy="Find out whether the controller used this sensor, and mend the recording if it did not.",
    ),
    "open_drift": _Quantity(
        name="whether the loop felt the sensor's drift",
        unit="mm",
        factor=MILLI,
        remedy="Find out whether the controller used this sensor, and mend the recording if it did not.",
    ),
    "open_filter": _Quantity(
        name="whether the command passed the filter of the measured displacement",
        unit="ms",
        factor=MILLI,
        remedy="State the filters of both channels, or use the same on both.",
    ),
    "yielding": _Quantity(
        name="whether the specimen yielded",
        unit="",
        factor=0.0,
        remedy="Record the force of the specimen, or state it as linear where it stayed so.",
    ),
    "specimen": _Quantity(
        name="what the force shows of the specimen",
        unit="%",
        factor=PERCENT,
        remedy="Repeat the test with less actuator error or a better force sensor, or calibrate a model of "
        "the specimen with `reliab diagnose`.",
    ),
    "mass": _Quantity(
        name="mass of the structure",
        unit="%",
        factor=PERCENT,
        remedy="Calibrate the load cell, and state mass and force to a smaller deviation.",
    ),
    "force_lag": _Quantity(
        name="lag of the force behind the displacement",
        unit="ms",
        factor=MILLI,
        remedy="Measure by how much the force is recorded late, and state it.",
    ),
    "attached_mass": _Quantity(
        name="mass between load cell and specimen",
        unit="kg",
        factor=1.0,
        remedy="Weigh what is mounted between load cell and specimen, and state it.",
    ),
    "load_path_friction": _Quantity(
        name="friction in the load path",
        unit="N",
        factor=1.0,
        remedy="Measure the friction of the load path without a specimen, and state it.",
    ),
    "damping": _Quantity(
        name="damping matrix",
        unit="%",
        factor=PERCENT,
        remedy="Measure the damping of the structure by a free vibration, and state its deviation.",
    ),
    "specimen_stiffness": _Quantity(
        name="specimen",
        unit="%",
        factor=PERCENT,
        remedy="Measure the specimen's stiffness, and state its deviation.",
    ),
    "floor_mass": _Quantity(
        name="mass of floor",
        unit="%",
        factor=PERCENT,
        remedy="Weigh the floors, and state the deviation of their masses.",
    ),
    "storey_stiffness": _Quantity(
        name="stiffness of storey",
        unit="%",
        factor=PERCENT,
        remedy="Measure the stiffness of the storeys, or natural frequencies, and state their deviations.",
    ),
    "storey_damping": _Quantity(
        name="damping of storey",
        unit="%",
        factor=PERCENT,
        remedy="Measure the damping of the storeys, or of the modes, and state its deviations.",
    ),
    "mode_frequency": _Quantity(
        name="natural frequency of mode",
        unit="%",
        factor=PERCENT,
        remedy="Measure the natural frequencies by a free vibration, and state their deviations.",
    ),
    "mode_damping_ratio": _Quantity(
        name="damping ratio of mode",
        unit="%",
        factor=PERCENT,
        remedy="Measure the damping ratios by a free vibration, and state their deviations.",
    ),
    "mass_entry": _Quantity(
        name="entry of the mass matrix in row and column",
        unit="%",
        factor=PERCENT,
        remedy="Weigh what moves, and state the deviation of the entry.",
    ),
    "damping_entry": _Quantity(
        name="entry of the damping matrix in row and column",
        unit="%",
        factor=PERCENT,
        remedy="Measure the damping ratios by a free vibration, and state their deviations.",
    ),
    "stiffness_entry": _Quantity(
        name="entry of the stiffness matrix in row and column",
        unit="%",
        factor=PERCENT,
        remedy="Measure the stiffness between these degrees of freedom, and state its deviation.",
    ),
    "initial_state": _Quantity(
        name="motion before the record",
        unit="mm",
        factor=MILLI,
        remedy="Record from rest: the error at the first sample is not known.",
    ),
    "sensor_noise": _Quantity(
        name="noise of the displacement sensor",
        unit="",
        factor=0.0,
        remedy="Use a displacement sensor with less noise.",
    ),
}


def budget_of_error(widenings: Iterable[Widening], sizes: Mapping[str, Size]) -> tuple[BudgetItem, ...]:
    """List what makes the interval of an error, the largest contribution first."""
    return tuple(_item(widening, sizes) for widening in widenings)


def _item(widening: Widening, sizes: Mapping[str, Size]) -> BudgetItem:
    """Describe a quantity of the test, or of one of its actuators, and what it contributes."""
    name, numbered = widening.name, part_and_number(widening.name)
    begin, _, number = name.rpartition("_")
    of_actuator = number.isdecimal() and not is_part(name)
    alike = begin if of_actuator else name
    quantity = _QUANTITIES[alike if numbered is None else numbered[0]]
    size = sizes.get(name, sizes.get(alike))
    return BudgetItem(
        name=name,
        quantity=_quantity_in_words(alike, quantity, number if of_actuator else ""),
        size=quantity.factor * widening.deviation if quantity.factor else None,
        unit=quantity.unit,
        source=Source.LEARNED if size is None else size.source,
        contribution=widening.contribution,
        remedy=quantity.remedy,
    )


def _quantity_in_words(name: str, quantity: _Quantity, actuator: str) -> str:
    if (numbered := part_and_number(name)) is not None:
        return f"{quantity.name} {numbered[1]}"
    if name in PARTS:
        return f"{quantity.name} 1, and of all others alike"
    return f"{quantity.name} of actuator {actuator}" if actuator else quantity.name
