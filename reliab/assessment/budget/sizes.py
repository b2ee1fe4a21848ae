"""How far each quantity of a test may be off: as stated, or as ordinary equipment has it."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from reliab.assessment.budget.equipment import Equipment
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.stated_value import StatedValue
from reliab.structures import Structure, is_part
from reliab.vocabulary import MILLI

if TYPE_CHECKING:
    from reliab.simulation.frames import FrameUnderTest


class Source(StrEnum):
    """Where a size comes from."""

    STATED = "stated"
    LEARNED = "learned from this test"
    DEFAULT = "default"


@dataclass(frozen=True, kw_only=True)
class Size:
    """Standard deviation of a quantity that is not known exactly."""

    deviation: float  # Relative [-], or in the SI unit of the quantity
    source: Source  # Where it comes from


_RELATIVE = {
    "frequency": "f",
    "damping_ratio": "xi",
    "experimental_fraction": "alpha",
    "sensor_scale": "scale",
}
_ABSOLUTE = {  # stated in milliseconds
    "time_shift": "skew",
    "feedback_lag": "feedback_lag",
    "filter_delay": "filter_delay",
}
_LAGGING = "lagging_hysteresis"  # where none was found: no reading leads
_OF_HYSTERESIS = 0.2  # of a hysteresis that is stated without its deviation, as a calibration gives it
_LARGEST_ASSUMED = 0.99
_OF_PARTS = {  # what is not assumed of the whole where parts of the structure are stated
    "damping": "damping_ratio",
    "floor_mass": "frequency",
    "storey_stiffness": "frequency",
    "storey_damping": "damping_ratio",
    "mode_frequency": "frequency",
    "mass_entry": "frequency",
    "stiffness_entry": "frequency",
    "damping_entry": "damping_ratio",
    "mode_damping_ratio": "damping_ratio",
    "specimen_stiffness": "experimental_fraction",
}
_OF_STRUCTURE = ("frequency", "damping_ratio", "experimental_fraction")


def sizes_of_unknown(
    stated: Mapping[str, StatedValue],
    structure: Structure,
    equipment: Equipment | None,
    time_step: float,
    *,
    calibrated: bool = False,
) -> dict[str, Size]:
    """Give the sizes of what is not known of a test, by the names of `Tolerances`.

    `time_step` [s]; without equipment only what is stated with a deviation is unknown. The structure of a
    calibrated model is known as well as the model says.
    """
    sizes = {} if equipment is None else _assumed(structure, equipment, time_step)
    of_sensor = stated.get("hysteresis", StatedValue(0.0))
    if "hysteresis" in stated:
        sizes.pop(_LAGGING, None)
    if of_sensor.value and equipment is not None:
        sizes["hysteresis"] = Size(deviation=_OF_HYSTERESIS * of_sensor.value, source=Source.DEFAULT)
    if calibrated:
        sizes = {name: size for name, size in sizes.items() if name not in _OF_STRUCTURE}
    open_hysteresis = "hysteresis" if of_sensor.value else _LAGGING
    for name, key in {**_RELATIVE, **_ABSOLUTE, open_hysteresis: "hysteresis"}.items():
        if key in stated and stated[key].deviation:
            relative = abs(stated[key].value) if name in _RELATIVE else 1.0
            unit = MILLI if name in _ABSOLUTE else 1.0
            if relative:
                deviation = stated[key].deviation / relative / unit
                sizes[name] = Size(deviation=deviation, source=Source.STATED)
    if (scale := stated.get("command_scale")) is not None and scale.deviation:
        together = float(np.hypot(_deviation_stated(sizes), scale.deviation / scale.value))
        sizes["sensor_scale"] = Size(deviation=together, source=Source.STATED)
    return sizes


def sizes_of_structure(frame: "FrameUnderTest") -> dict[str, Size]:
    """Sizes that tolerances state; a factor of M acts as its inverse does on C, K and k_e.

    Where parts of the structure are stated, nothing is assumed of the whole beside them.
    """
    tolerances = frame.tolerances
    parts = tolerances.of_parts(frame.partition.size)
    deviations = {
        "frequency": tolerances.of_frequency,
        "damping_ratio": tolerances.damping_ratio,
        "experimental_fraction": tolerances.of_specimen_alone,
    }
    stated = {_OF_PARTS[name.rstrip("_0123456789")] for name in parts}
    return {
        name: Size(deviation=deviation, source=Source.STATED)
        for name, deviation in {**deviations, **parts}.items()
        if deviation or name in stated
    }


def _deviation_stated(sizes: Mapping[str, Size]) -> float:
    """Relative deviation of the measured displacement's scale where one is stated, else zero."""
    scale = sizes.get("sensor_scale")
    return scale.deviation if scale is not None and scale.source is Source.STATED else 0.0


def tolerances_of(sizes: Mapping[str, Size]) -> Tolerances:
    """Put sizes into the form in which the error is drawn."""
    deviations = {name: size.deviation for name, size in sizes.items()}
    of_parts = {name: deviations.pop(name) for name in sizes if is_part(name)}
    of_sensors = {name: deviations.pop(name) for name in sizes if name[-1].isdecimal() and name in deviations}
    return Tolerances(**deviations, of_parts=of_parts, of_sensors=of_sensors)


def as_certain_as(sizes: Mapping[str, Size], probability: float) -> float:
    """Limit a probability to 0.01 to 0.99 where sizes are assumed: rare sizes are not known so well."""
    if any(size.source is Source.DEFAULT for size in sizes.values()):
        return min(max(probability, 1.0 - _LARGEST_ASSUMED), _LARGEST_ASSUMED)
    return probability


def _assumed(structure: Structure, equipment: Equipment, time_step: float) -> dict[str, Size]:
    """Sizes of ordinary equipment."""
    deviations = {
        "frequency": equipment.f,
        "damping_ratio": equipment.xi,
        "experimental_fraction": equipment.alpha if structure.experimental_fraction < 1.0 else 0.0,
        "sensor_scale": equipment.scale,
        "time_shift": equipment.skew(time_step),
        "feedback_lag": equipment.feedback_lag_ms / MILLI,
        "filter_delay": equipment.filter_delay_ms / MILLI,
        _LAGGING: equipment.hysteresis,
    }
    return {
        name: Size(deviation=deviation, source=Source.DEFAULT)
        for name, deviation in deviations.items()
        if deviation
    }
