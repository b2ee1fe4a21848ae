"""Arguments as users state them: numbers with their standard deviations, and those that would not be used.

Messages name an argument in backquotes, `` `xi` ``, or with its value, `` `time_units="ms"` ``; the command
line writes them as its options.
"""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Final

from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue, require_physical

if TYPE_CHECKING:
    from reliab.assessment.budget.sizes import Equipment
    from reliab.recordings.recording import Recording
    from reliab.signals.filters import LowPass
    from reliab.structures.structure import Structure


LINEAR: Final = "linear"
"""A specimen that is stated as linear."""

_MEASURED = "measured"
_RANGED = ("scale", "mass", "hysteresis", "resolution")

STRUCTURE_NAMES: Final = ("f", "xi", "alpha")
"""Names of what describes a structure of one mass."""

STATED_BY_MODEL: Final = (*STRUCTURE_NAMES, "feedback_lag")
"""Names of what the model of a test that is followed states."""


def stated_quantities(question: Mapping[str, object]) -> dict[str, StatedValue]:
    """Select the quantities that a question states.

    >>> stated_quantities({"f": StatedValue(1.0, 0.01), "mass": None, "threshold": 0.05})
    {'f': StatedValue(value=1.0, deviation=0.01)}
    """
    return {name: quantity for name, quantity in question.items() if isinstance(quantity, StatedValue)}


def exact_quantities(question: Mapping[str, object]) -> dict[str, float]:
    """Select the quantities that are stated before a test, without standard deviations."""
    values = stated_quantities(question)
    for name, quantity in values.items():
        if quantity.deviation:
            raise InputError(
                "A design takes exact values",
                value=f"`{name}={quantity}`",
                remedy="Leave the standard deviation out, or give several exact values",
            )
    return {name: quantity.value for name, quantity in values.items()}


def require_sound(values: Mapping[str, StatedValue]) -> None:
    """Refuse scales, a mass and properties of channels that no laboratory has.

    A hysteresis may be zero with a standard deviation, as a calibration finds it.
    """
    for name, quantity in values.items():
        if (kind := name.removeprefix("command_")) in _RANGED:
            may_be_zero = name == "hysteresis" and quantity.deviation > 0.0
            require_physical(kind, quantity.value, zero=may_be_zero, label=f"value of `{name}`")


def parse_threshold(threshold: float | None) -> float:
    """Read the error that a test may have, 0.05 by default."""
    limit = 0.05 if threshold is None else float(threshold)
    require_physical("error threshold", limit, label="value of `threshold`")
    return limit


def choose_equipment(equipment: "Equipment | None", *, exact: bool) -> "Equipment":
    """Choose the accuracy of a laboratory's equipment, that of ordinary equipment by default."""
    from reliab.assessment.budget.sizes import exact_equipment, ordinary_equipment

    if exact:
        if equipment is not None:
            raise refuse_unused(
                "equipment", "together with `exact`, which takes all quantities as known exactly"
            )
        return exact_equipment()
    return equipment or ordinary_equipment()


def require_known_specimen(specimen: str | None, *, has_model: bool = False) -> bool:
    """Refuse what no specimen is known by; return whether it is measured.

    >>> require_known_specimen("measured"), require_known_specimen("linear"), require_known_specimen(None)
    (True, False, False)
    """
    if specimen not in (None, LINEAR, _MEASURED):
        raise InputError(
            "Unknown kind of specimen",
            value=repr(specimen),
            remedy=f"Give `specimen` as {LINEAR} or {_MEASURED}",
        )
    if specimen is not None and has_model:
        raise refuse_unused("specimen", "together with `model`, which describes the specimen")
    return specimen == _MEASURED


def parse_filters(texts: Iterable[str]) -> "dict[str, LowPass]":
    """Read the filters of the channels.

    >>> parse_filters(["measured=200/4"])
    {'measured': LowPass(corner=200.0, order=4)}
    """
    from reliab.assessment.budget.corrections import CHANNELS
    from reliab.signals.filters import LowPass

    filters: dict[str, LowPass] = {}
    for text in texts:
        channel, _, low_pass = text.partition("=")
        if channel not in CHANNELS or channel in filters:
            raise InputError(
                "A `filter` is stated once for each channel",
                value=repr(text),
                remedy="Write measured=200 or command=200/4",
            )
        filters[channel] = LowPass.parse(low_pass)
    return filters


def refuse_unused(name: str, reason: str, remedy: str = "Leave it out") -> InputError:
    """Describe an argument that would have no effect.

    `reason`: beside or without what it has no effect.
    """
    return InputError(f"`{name}` has no effect {reason}", remedy=remedy)


def refuse_stated(
    question: Mapping[str, object],
    *names: str,
    reason: str,
    remedy: str = "Leave it out",
    defaults: Mapping[str, float] | None = None,
) -> None:
    """Refuse arguments of a question that would have no effect; `reason` as of :func:`refuse_unused`.

    `defaults`: values that hold anyway, so that they may be stated.
    """
    for name in names:
        default = (defaults or {}).get(name)
        if question[name] is not None and (default is None or question[name] != StatedValue(default)):
            raise refuse_unused(name, reason, remedy)


_TOLERANCE_OF_MODEL: Final = 0.01  # relative difference up to which a stated structure is that of a model


def values_of_structure(structure: "Structure | None") -> dict[str, StatedValue]:
    """Frequency, damping ratio and share of a structure where there is one, without deviations."""
    if structure is None:
        return {}
    return {
        "f": StatedValue(structure.frequency),
        "xi": StatedValue(structure.damping_ratio),
        "alpha": StatedValue(structure.experimental_fraction),
    }


def structure_of(values: Mapping[str, StatedValue], **usual: float) -> "Structure":
    """Make a structure of what is stated, and of usual values of `f`, `xi` and `alpha` (1) for the rest."""
    from reliab.structures.structure import Structure

    numbers = {"alpha": 1.0, **usual, **{name: quantity.value for name, quantity in values.items()}}
    return Structure(
        frequency=numbers["f"], damping_ratio=numbers["xi"], experimental_fraction=numbers["alpha"]
    )


def collect_stated_values(
    recording: "Recording", numbers: Mapping[str, StatedValue], values_of_model: Mapping[str, StatedValue]
) -> dict[str, StatedValue]:
    """Take what is stated, else what the model or the file's header states; check that they agree."""
    if "mass" in numbers and recording.force is None:
        raise refuse_unused("mass", "without a column of force")
    values = {**recording.stated, **values_of_model, **numbers}
    require_sound(values)
    if "f" not in values:
        raise InputError(
            "The verdict depends on the natural frequency of the structure",
            remedy='Give it in hertz: `f=1`, or `f="1±0.01"` with its standard deviation',
            where=recording.name,
        )
    for name, value in values_of_model.items():
        if abs(values[name].value / value.value - 1.0) > _TOLERANCE_OF_MODEL:
            raise InputError(
                "The model is of another structure",
                value=f"{name} = {values[name]} from you, {value} in the model",
                remedy=f"Leave `{name}` out, or calibrate the model for this structure",
                where=recording.name,
            )
    return values
