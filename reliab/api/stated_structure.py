"""What is stated of the structure of a test: by arguments, by a model, by the file's header."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

from reliab.api.arguments import require_positive, unused
from reliab.errors import InputError
from reliab.recordings import Recording
from reliab.stated_value import StatedValue
from reliab.structures import Structure

if TYPE_CHECKING:
    from reliab.simulation.hybrid_test import UpdatedModel

_SAME: Final = 0.01  # relative difference up to which a stated structure is that of a model


def exactly_stated(structure: Structure) -> dict[str, StatedValue]:
    """Frequency, damping ratio and share of a structure, without deviations."""
    return {
        "f": StatedValue(structure.frequency),
        "xi": StatedValue(structure.damping_ratio),
        "alpha": StatedValue(structure.experimental_fraction),
    }


def stated_by_model(model: "UpdatedModel") -> dict[str, StatedValue]:
    """Take what a model states of its structure."""
    return {} if model.test.structure is None else exactly_stated(model.test.structure)


def stated_of_test(
    recording: Recording, numbers: Mapping[str, StatedValue], of_model: Mapping[str, StatedValue]
) -> dict[str, StatedValue]:
    """Take what is stated, else what the model or the file's header states; check that they agree."""
    if "mass" in numbers and recording.force is None:
        raise unused("mass", "without a column of force")
    stated = {**recording.stated, **of_model, **numbers}
    require_positive(stated)
    if "f" not in stated:
        raise InputError(
            "The natural frequency of the structure must be stated",
            value="no `f`",
            remedy='Give it in hertz, `f=1` or `f="1±0.01"`; the verdict depends on it',
            where=recording.name,
        )
    for name, value in of_model.items():
        if abs(stated[name].value / value.value - 1.0) > _SAME:
            raise InputError(
                "The structure must be that of the model",
                value=f"{name} = {stated[name]} against {value}",
                remedy=f"Leave `{name}` out, or calibrate the model for this structure",
                where=recording.name,
            )
    return stated
