"""The budget of a test's uncertainty: sizes, what each contributes, and what would reduce it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from reliab.assessment.budget.sizes import Size, Source
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.core.vocabulary import MILLI, PERCENT
from reliab.structures.parts_of_structure import PARTS, is_part, part_and_number


@dataclass(frozen=True, kw_only=True)
class BudgetItem:
    """One quantity of the budget of a test's uncertainty."""

    name: str  # Key of what is not known exactly
    quantity: str  # The same in words
    size: float | None  # One standard deviation of it, in `unit`; None for noise, whose spectrum is estimated
    unit: str  # Unit of the size
    source: Source  # Whether the size was stated, learned from the test, or is that of ordinary equipment
    contribution: float  # Standard deviation of the error that it alone causes [-]
    remedy: str  # What would reduce it, a sentence

    def to_dict(self) -> dict[str, Any]:
        """Put it into plain values."""
        return {**vars(self), "source": str(self.source)}


_IN_WORDS = {
    "frequency": ("natural frequency", "%"),
    "damping_ratio": ("damping ratio", "%"),
    "experimental_fraction": ("share of the stiffness", "%"),
    "sensor_scale": ("scale of the displacement sensor", "%"),
    "sensor_offset": ("offset of the displacement sensor", "mm"),
    "time_shift": ("skew of the channels", "ms"),
    "feedback_lag": ("lag of the fed-back force", "ms"),
    "filter_delay": ("filters of the channels", "ms"),
    "hysteresis": ("hysteresis of the displacement sensor", "%"),
    "lagging_hysteresis": ("hysteresis of the displacement sensor", "%"),
    "sensor_drift": ("drift of the displacement sensor", "mm"),
    "open_offset": ("whether the loop felt the sensor's offset", "mm"),
    "open_drift": ("whether the loop felt the sensor's drift", "mm"),
    "open_filter": ("whether the command passed the filter of the measured displacement", "ms"),
    "yielding": ("whether the specimen yielded", ""),
    "specimen": ("what the force shows of the specimen", "%"),
    "mass": ("mass of the structure", "%"),
    "force_lag": ("lag of the force behind the displacement", "ms"),
    "attached_mass": ("mass between load cell and specimen", "kg"),
    "load_path_friction": ("friction in the load path", "N"),
    "damping": ("damping matrix", "%"),
    "specimen_stiffness": ("specimen", "%"),
    "floor_mass": ("mass of floor", "%"),
    "storey_stiffness": ("stiffness of storey", "%"),
    "storey_damping": ("damping of storey", "%"),
    "mode_frequency": ("natural frequency of mode", "%"),
    "mode_damping_ratio": ("damping ratio of mode", "%"),
    "mass_entry": ("entry of the mass matrix in row and column", "%"),
    "damping_entry": ("entry of the damping matrix in row and column", "%"),
    "stiffness_entry": ("entry of the stiffness matrix in row and column", "%"),
    "initial_state": ("motion before the record", "mm"),
    "sensor_noise": ("noise of the displacement sensor", ""),
}
"""What is not known exactly, in words, with the unit of its size; none where no size is stated."""

_FACTORS = {"%": PERCENT, "mm": MILLI, "ms": MILLI, "kg": 1.0, "N": 1.0}
"""From the unit in which a quantity is drawn to that of the budget."""

_REMEDIES = {
    "frequency": "Measure the natural frequency in a free vibration, and state its standard deviation.",
    "damping_ratio": "Measure the damping ratio in a free vibration, and state its standard deviation.",
    "experimental_fraction": "Measure the specimen's stiffness, and state the deviation of its share.",
    "sensor_scale": "Calibrate the displacement sensor and give its `scale`.",
    "sensor_offset": "Record some seconds of rest before the test, which show the sensor's offset.",
    "time_shift": "Feed one signal to both channels (`reliab calibrate`) and give the `skew`.",
    "feedback_lag": "Measure by how much the force is fed back late, and state it.",
    "filter_delay": "State the filters of both channels, or use the same on both.",
    "hysteresis": "Measure the sensor's hysteresis by a slow cycle, and state it.",
    "lagging_hysteresis": "Measure the sensor's hysteresis by a slow cycle, and state it.",
    "sensor_drift": "Record rest before and after the test, which shows the sensor's drift.",
    "open_offset": (
        "Find out whether the controller used this sensor, and correct the recording if it did not."
    ),
    "open_drift": (
        "Find out whether the controller used this sensor, and correct the recording if it did not."
    ),
    "open_filter": "State the filters of both channels, or use the same on both.",
    "yielding": "Record the force of the specimen, or state it as linear if it stayed linear.",
    "specimen": "Repeat the test with less actuator error or a better force sensor, or calibrate a model "
    "of the specimen with `reliab diagnose`.",
    "mass": "Calibrate the load cell, and state mass and force to a smaller deviation.",
    "force_lag": "Measure by how much the force is recorded late, and state it.",
    "attached_mass": "Weigh what is mounted between load cell and specimen, and state it.",
    "load_path_friction": "Measure the friction of the load path without a specimen, and state it.",
    "damping": "Measure the damping of the structure by a free vibration, and state its deviation.",
    "specimen_stiffness": "Measure the specimen's stiffness, and state its deviation.",
    "floor_mass": "Weigh the floors, and state the deviation of their masses.",
    "storey_stiffness": "Measure the stiffness of the storeys, or natural frequencies, and state their "
    "deviations.",
    "storey_damping": "Measure the damping of the storeys, or of the modes, and state its deviations.",
    "mode_frequency": "Measure the natural frequencies by a free vibration, and state their deviations.",
    "mode_damping_ratio": "Measure the damping ratios by a free vibration, and state their deviations.",
    "mass_entry": "Weigh what moves, and state the deviation of the entry.",
    "damping_entry": "Measure the damping ratios by a free vibration, and state their deviations.",
    "stiffness_entry": "Measure the stiffness between these degrees of freedom, and state its deviation.",
    "initial_state": "Record from rest: the error at the first sample is not known.",
    "sensor_noise": "Use a displacement sensor with less noise.",
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
    kind = alike if numbered is None else numbered[0]
    words, unit = _IN_WORDS[kind]
    size = sizes.get(name, sizes.get(alike))
    return BudgetItem(
        name=name,
        quantity=_with_number(words, alike, number if of_actuator else ""),
        size=_FACTORS[unit] * widening.deviation if unit else None,
        unit=unit,
        source=Source.LEARNED if size is None else size.source,
        contribution=widening.contribution,
        remedy=_REMEDIES[kind],
    )


def part_in_words(name: str) -> tuple[str, str]:
    """Name a part of a structure, such as "storey_stiffness_2", and what would reduce its uncertainty."""
    numbered = part_and_number(name)
    kind = name if numbered is None else numbered[0]
    return _with_number(_IN_WORDS[kind][0], name, ""), _REMEDIES[kind]


def _with_number(words: str, name: str, actuator: str) -> str:
    if (numbered := part_and_number(name)) is not None:
        return f"{words} {numbered[1]}"
    if name in PARTS:
        return f"{words} 1 and, equally, of all others"
    return f"{words} of actuator {actuator}" if actuator else words
