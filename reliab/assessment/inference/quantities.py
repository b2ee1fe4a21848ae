"""All uncertain quantities of a test, one row each."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

from reliab.assessment.budget.sizes import DEVIATION_OF_HYSTERESIS, Equipment, PriorSource
from reliab.assessment.inference.uncertain_quantity import Circumstances, Description, Prior, Quantity, Shape
from reliab.core.vocabulary import MILLI
from reliab.structures.parts_of_structure import PARTS, is_part, part_and_number

_NEGLIGIBLE_STIFFNESS = 1e-9  # of the stiffness, below which nothing is computed
_MOVING_START = "Record from rest: the error at the first sample is not known."
_FILTERS = "State the filters of both channels, or use the same on both."
_FREE_VIBRATION = "Measure the damping ratios by a free vibration, and state their deviations."
_SENSOR_REMEDY = "Find out whether the controller used this sensor, and correct the recording if it did not."


def _skew(circumstances: Circumstances, equipment: Equipment) -> float:
    return equipment.skew(circumstances.channels.band.record_step)


def _lag_of_further_channel(circumstances: Circumstances, equipment: Equipment) -> float:
    """Return the standard deviation of the time by which skew and filter make a further channel late [s]."""
    return math.hypot(_skew(circumstances, equipment), equipment.filter_delay_ms / MILLI)


def _size_with_ground(
    size: Callable[[Circumstances, Equipment], float],
) -> Callable[[Circumstances, Equipment], float]:
    return lambda circumstances, equipment: (
        0.0 if circumstances.channels.ground is None else size(circumstances, equipment)
    )


def _size_with_force(
    size: Callable[[Circumstances, Equipment], float],
) -> Callable[[Circumstances, Equipment], float]:
    return lambda circumstances, equipment: (
        size(circumstances, equipment) if circumstances.specimen_force else 0.0
    )


def _share(circumstances: Circumstances, equipment: Equipment) -> float:
    """Return the deviation of the share, which can be wrong where part of the stiffness is computed."""
    partition = circumstances.partition
    shared = abs(partition.numerical_stiffness).max() > _NEGLIGIBLE_STIFFNESS * abs(partition.stiffness).max()
    return equipment.alpha if shared else 0.0


def _hysteresis(quantity: Quantity, circumstances: Circumstances) -> Prior | None:
    """Prior of the width: positive where none was corrected, since no reading leads."""
    stated_value = circumstances.stated.get(quantity.option)
    if stated_value is not None and stated_value.value:
        return quantity.stated_prior(stated_value.deviation or DEVIATION_OF_HYSTERESIS * stated_value.value)
    if stated_value is not None and not stated_value.deviation:
        return None  # a calibration found none
    prior = quantity.usual_prior(circumstances)
    return None if prior is None else replace(prior, shape=Shape.POSITIVE)


def _scale(quantity: Quantity, circumstances: Circumstances) -> Prior | None:
    """Prior of the sensor's scale, with the deviation that is stated of the command's scale."""
    prior = quantity.usual_prior(circumstances)
    command_scale = circumstances.stated.get("command_scale")
    if command_scale is None or not command_scale.deviation:
        return prior
    sensor_deviation = prior.deviation if prior is not None and prior.source is PriorSource.STATED else 0.0
    deviation = math.hypot(sensor_deviation, command_scale.deviation / command_scale.value)
    return quantity.stated_prior(deviation)


QUANTITIES = (
    Quantity(
        name="filter_delay",  # that the filters of the two channels do not have in common
        words="filters of the channels",
        unit="ms",
        remedy=_FILTERS,
        changes="skew",
        ordinary=lambda _, equipment: equipment.filter_delay_ms / MILLI,
        actuator_specific=True,
        option="filter_delay",
    ),
    Quantity(
        name="time_shift",  # by which the measured displacement was recorded later than the command
        words="skew of the channels",
        unit="ms",
        remedy="Feed one signal to both channels (`reliab calibrate`) and give the `skew`.",
        changes="skew",
        ordinary=_skew,
        actuator_specific=True,
        option="skew",
    ),
    Quantity(
        name="damping_ratio",  # common factor of all
        words="damping ratio",
        unit="%",
        remedy="Measure the damping ratio in a free vibration, and state its standard deviation.",
        changes="damping_ratio",
        by_factor=True,
        ordinary=lambda _, equipment: equipment.xi,
        shape=Shape.LOGNORMAL,
        option="xi",
        relative=True,
    ),
    Quantity(
        name="feedback_lag",  # of the force behind the displacement of the same instant
        words="lag of the fed-back force",
        unit="ms",
        remedy="Measure by how much the force is fed back late, and state it.",
        changes="feedback_lag",
        ordinary=lambda _, equipment: equipment.feedback_lag_ms / MILLI,
        option="feedback_lag",
    ),
    Quantity(
        name="mass",  # recorded force over the true one, for the stated mass
        words="mass of the structure and scale of the load cell",
        unit="%",
        remedy="Calibrate the load cell, and state mass and force to a smaller deviation.",
        changes="force_scale",
        by_factor=True,
        ordinary=_size_with_force(lambda _, equipment: equipment.force_scale),
        actuator_specific=True,
        option="mass",
        relative=True,
    ),
    Quantity(
        name="force_lag",  # by which the force was recorded later than the command
        words="lag of the recorded force",
        unit="ms",
        remedy="Measure by how much the force is recorded late, and state it.",
        changes="force_skew",
        ordinary=_size_with_force(_lag_of_further_channel),
        actuator_specific=True,
        option="force_lag",
    ),
    Quantity(
        name="specimen_lead",  # of the force before the displacement, by viscous damping
        words="viscous damping of the specimen",
        unit="ms",
        remedy="Measure by how much the force is recorded late, and state it.",
        changes="specimen_lead",
        shape=Shape.POSITIVE,
    ),
    Quantity(
        name="attached_mass",  # that a learned specimen's force holds beyond the stated one
        words="mass between load cell and specimen",
        unit="kg",
        remedy="Weigh what is mounted between load cell and specimen, and state it.",
        changes="attached_mass",
    ),
    Quantity(
        name="load_path_friction",
        words="friction in the load path",
        unit="N",
        remedy="Measure the friction of the load path without a specimen, and state it.",
        changes="load_path_friction",
    ),
    Quantity(
        name="ground_scale",  # of the recorded ground acceleration over the one that the computer applied
        words="scale of the ground acceleration",
        unit="%",
        remedy="Record the ground acceleration that the computer applied.",
        changes="ground_scale",
        by_factor=True,
        ordinary=_size_with_ground(lambda _, equipment: equipment.ground_scale),
    ),
    Quantity(
        name="ground_skew",  # by which it was recorded later than the command
        words="skew of the ground acceleration",
        unit="ms",
        remedy="Record the ground acceleration at the same instants as the command.",
        changes="ground_skew",
        ordinary=_size_with_ground(_lag_of_further_channel),
    ),
    Quantity(
        name="initial_state",  # error of the command at the first sample
        words="motion before the record",
        unit="mm",
        remedy=_MOVING_START,
        changes="initial_displacement",
        ordinary=lambda known, _: known.channels.initial_size,
    ),
    Quantity(
        name="initial_velocity",  # rate of the same, over the lowest natural frequency
        words="motion before the record",
        unit="mm",
        remedy=_MOVING_START,
        changes="initial_velocity",
        ordinary=lambda known, _: known.channels.initial_size,
    ),
    Quantity(
        name="integration",  # error of the computer's time stepping, over (ω·step)² of the specimen's force
        words="numerical integration",
        unit="",
        remedy="Compute the numerical part in smaller steps.",
        changes="integration",
        ordinary=_size_with_ground(lambda _, equipment: equipment.integration),
    ),
    Quantity(
        name="ground_interpolation",  # between its samples, over (ω·step)² of it; 1/12 by straight lines
        words="interpolation of the ground acceleration",
        unit="",
        remedy="Compute the numerical part in smaller steps.",
        changes="ground_interpolation",
        ordinary=_size_with_ground(lambda _, equipment: equipment.integration),
    ),
    Quantity(
        name="frequency",  # common factor of all
        words="natural frequency",
        unit="%",
        remedy="Measure the natural frequency in a free vibration, and state its standard deviation.",
        changes="frequency",
        by_factor=True,
        ordinary=lambda _, equipment: equipment.f,
        shape=Shape.LOGNORMAL,
        option="f",
        relative=True,
    ),
    Quantity(
        name="open_drift",
        words="whether the loop felt the sensor's drift",
        unit="mm",
        remedy=_SENSOR_REMEDY,
        changes="drift",
        actuator_specific=True,
        shape=Shape.EITHER,
    ),
    Quantity(
        name="open_filter",  # delay of a filter of the measured displacement that the command may have passed
        words="whether the command passed the filter of the measured displacement",
        unit="ms",
        remedy=_FILTERS,
        changes="skew",
        actuator_specific=True,
        shape=Shape.EITHER,
    ),
    Quantity(
        name="open_offset",
        words="whether the loop felt the sensor's offset",
        unit="mm",
        remedy=_SENSOR_REMEDY,
        changes="offset",
        actuator_specific=True,
        shape=Shape.EITHER,
    ),
    Quantity(
        name="sensor_drift",  # rise of the readings over the test that the motion does not have
        words="drift of the displacement sensor",
        unit="mm",
        remedy="Record rest before and after the test, which shows the sensor's drift.",
        changes="drift",
        ordinary=lambda known, _: float(known.channels.drift_size[known.actuator]),
        actuator_specific=True,
    ),
    Quantity(
        name="hysteresis",  # width of the sensor's loop over the span of its motion
        words="hysteresis of the displacement sensor",
        unit="%",
        remedy="Measure the sensor's hysteresis by a slow cycle, and state it.",
        changes="hysteresis",
        ordinary=lambda _, equipment: equipment.hysteresis,
        actuator_specific=True,
        option="hysteresis",
        special=_hysteresis,
    ),
    Quantity(
        name="sensor_offset",  # constant part of the readings that the motion does not have
        words="offset of the displacement sensor",
        unit="mm",
        remedy="Record some seconds of rest before the test, which show the sensor's offset.",
        changes="offset",
        ordinary=lambda known, _: float(known.channels.offset_size[known.actuator]),
        actuator_specific=True,
    ),
    Quantity(
        name="sensor_scale",  # readings over the motion, relative to the scale of the command
        words="scale of the displacement sensor",
        unit="%",
        remedy="Calibrate the displacement sensor and give its `scale`.",
        changes="scale",
        by_factor=True,
        ordinary=lambda _, equipment: equipment.scale,
        actuator_specific=True,
        option="scale",
        relative=True,
        special=_scale,
    ),
    Quantity(
        name="experimental_fraction",  # factor of the specimen's stiffness, damping and mass
        words="share of the stiffness",
        unit="%",
        remedy="Measure the specimen's stiffness, and state the deviation of its share.",
        changes="share",
        by_factor=True,
        ordinary=_share,
        option="alpha",
        relative=True,
    ),
)


_PARTS = {  # words, and what would reduce the uncertainty
    "damping": (
        "damping matrix",
        "Measure the damping of the structure by a free vibration, and state its deviation.",
    ),
    "specimen_stiffness": ("specimen", "Measure the specimen's stiffness, and state its deviation."),
    "floor_mass": ("mass of floor", "Weigh the floors, and state the deviation of their masses."),
    "storey_stiffness": (
        "stiffness of storey",
        "Measure the stiffness of the storeys, or natural frequencies, and state their deviations.",
    ),
    "storey_damping": (
        "damping of storey",
        "Measure the damping of the storeys, or of the modes, and state its deviations.",
    ),
    "mode_frequency": (
        "natural frequency of mode",
        "Measure the natural frequencies by a free vibration, and state their deviations.",
    ),
    "mode_damping_ratio": ("damping ratio of mode", _FREE_VIBRATION),
    "mass_entry": (
        "entry of the mass matrix in row and column",
        "Weigh what moves, and state the deviation of the entry.",
    ),
    "damping_entry": ("entry of the damping matrix in row and column", _FREE_VIBRATION),
    "stiffness_entry": (
        "entry of the stiffness matrix in row and column",
        "Measure the stiffness between these degrees of freedom, and state its deviation.",
    ),
}


@cache
def part_of_structure(name: str) -> Quantity:
    """Relative change of a part that a frame's file states with a tolerance, such as "storey_stiffness_2"."""
    kind, number = part_and_number(name) or (name, "1 and, equally, of all others" if name in PARTS else "")
    words, remedy = _PARTS[kind]
    shape = Shape.LOGNORMAL if "damping" in name else Shape.NORMAL
    return Quantity(
        name=name, words=f"{words} {number}".rstrip(), unit="%", remedy=remedy, changes=name, shape=shape
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class UncertainQuantity:
    """A quantity of a test, or of one of its actuators, with its prior."""

    quantity: Quantity
    prior: Prior
    actuator: int = 0
    name: str = ""  # Key in JSON

    @property
    def assumed(self) -> bool:
        """Whether its size is that of ordinary equipment, which a user could state."""
        return bool(self.quantity.option) and self.prior.source is PriorSource.DEFAULT

    @property
    def described(self) -> Description:
        """The quantity for readers, with its actuator if there are several."""
        return (
            self.quantity
            if self.name == self.quantity.name
            else self.quantity.describe_for_actuator(self.actuator + 1)
        )


def list_unknowns(circumstances: Circumstances) -> tuple[UncertainQuantity, ...]:
    """List what is uncertain about a test."""
    part_quantities = [part_of_structure(name) for name in circumstances.tolerances if is_part(name)]
    unknowns: list[UncertainQuantity] = []
    for quantity in (*QUANTITIES, *part_quantities):
        for actuator in range(circumstances.partition.degrees if quantity.actuator_specific else 1):
            actuator_circumstances = replace(circumstances, actuator=actuator)
            prior = quantity.prior(actuator_circumstances)
            if prior is not None:
                name = (
                    actuator_circumstances.name_quantity(quantity.name)
                    if quantity.actuator_specific
                    else quantity.name
                )
                unknowns.append(
                    UncertainQuantity(quantity=quantity, prior=prior, actuator=actuator, name=name)
                )
    return tuple(unknowns)
