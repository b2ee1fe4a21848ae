"""How far each quantity of a test may be off: as stated, or as ordinary equipment has it."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from reliab.assessment.budget.equipment import Equipment
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.stated_value import StatedValue
from reliab.structures import Structure
from reliab.vocabulary import MILLI


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
_ABSOLUTE = {"time_shift": "skew", "feedback_lag": "feedback_lag"}  # stated in milliseconds


def sizes_of_unknown(
    stated: Mapping[str, StatedValue], structure: Structure, equipment: Equipment | None, time_step: float
) -> dict[str, Size]:
    """Give the sizes of what is not known of a test, by the names of `Tolerances`.

    `time_step` [s]; without equipment only what is stated with a deviation is unknown.
    """
    sizes = {} if equipment is None else _assumed(stated, structure, equipment, time_step)
    for name, key in {**_RELATIVE, **_ABSOLUTE, "hysteresis": "hysteresis"}.items():
        if key in stated and stated[key].deviation:
            relative = abs(stated[key].value) if name in _RELATIVE else 1.0
            unit = MILLI if name in _ABSOLUTE else 1.0
            if relative:
                deviation = stated[key].deviation / relative / unit
                sizes[name] = Size(deviation=deviation, source=Source.STATED)
    return sizes


def tolerances_of(sizes: Mapping[str, Size]) -> Tolerances:
    """Put sizes into the form in which the error is drawn."""
    return Tolerances(**{name: size.deviation for name, size in sizes.items()})


def _assumed(
    stated: Mapping[str, StatedValue], structure: Structure, equipment: Equipment, time_step: float
) -> dict[str, Size]:
    """Sizes of ordinary equipment."""
    deviations = {
        "frequency": equipment.f,
        "damping_ratio": equipment.xi,
        "experimental_fraction": equipment.alpha if structure.experimental_fraction < 1.0 else 0.0,
        "sensor_scale": equipment.scale,
        "time_shift": equipment.skew(time_step),
        "feedback_lag": equipment.feedback_lag_ms / MILLI,
        "filter_delay": 0.0 if "filter" in stated else equipment.filter_delay_ms / MILLI,
        "hysteresis": equipment.hysteresis,
    }
    return {
        name: Size(deviation=deviation, source=Source.DEFAULT)
        for name, deviation in deviations.items()
        if deviation
    }
