"""Recorded ground accelerations as the motion of the test shows them.

The loop's equation of motion is fitted with the channel as it is recorded; where that does not explain the
motion, with the channel reversed, in other units, and as the absolute acceleration of the structure.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from reliab.assessment.contradictions import Contradiction
from reliab.assessment.rebuilt_error.identification import Identification, identify
from reliab.assessment.rebuilt_error.kernel import Kernel, fit_equation
from reliab.assessment.recorded_force import other_unit_of_force, unit_like
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.recordings.coupled_recording import CoupledRecording
from reliab.recordings.recording import Part, Recording
from reliab.structures.structure import Structure

UNITS_OF_GROUND: Final = {
    "m/s2": 1.0,
    "g": STANDARD_GRAVITY,
    "gal": 1e-2,
    "mm/s2": 1e-3,
    "ft/s2": 0.3048,
    "in/s2": 0.0254,
}
"""Units of an acceleration [m/s²], as the names of columns hold them."""

_LARGEST_MISFIT = 0.3
"""Largest residual over ground acceleration; above it the channel is not this test's ground motion."""

_FARTHEST = 0.25  # of the stated frequency, by which an identified one may differ
_UNIT_TOLERANCE = 0.25
_SAME_FORCE = 0.2
_SAME_UNIT = 0.05  # of a unit, by which a calibrated channel may differ from it
_FEWEST_PERIODS = 5.0
_TOO_SHORT = "The test is too short for its structure to be identified from the recorded ground acceleration."
_SIGN_NOTE = "The ground acceleration has the opposite sign."
_ABSOLUTE = (
    "The channel of the ground acceleration is not this test's ground acceleration: it moves as the absolute "
    "acceleration of the structure does, that of ground and response together. Nothing was learned from it. "
    "Record the acceleration of the ground."
)
_REMEDY = "Check channel, unit and range of the ground acceleration, and the description of the structure."


@dataclass(frozen=True, kw_only=True)
class ShownGround:
    """What a recorded ground acceleration shows."""

    identified: Identification | None = None  # The structure; None where the channel does not show it
    notes: tuple[str, ...] = ()  # What was found about the channel, in sentences
    doubts: tuple[Contradiction, ...] = ()  # Where it contradicts the test
    sign: float = 1.0  # −1 where the channel has the opposite sign

    def evidence(self, ground: Array | None) -> Array | None:
        """Return the ground acceleration of the test by its channel [m/s²]; None where it shows nothing."""
        return None if ground is None or self.identified is None else self.sign * ground


@dataclass(frozen=True, kw_only=True)
class _Reading:
    """A way to read the channel."""

    factor: float  # To m/s², with its sign [-]
    absolute: bool = False  # Whether it is the absolute acceleration


def examine_ground(
    recording: Recording, structure: Structure, *, mass: float | None, feedback_lag: float
) -> ShownGround:
    """Identify the structure from the recorded ground acceleration, or say why it cannot be this test's.

    `mass` of the structure [kg], with which a recorded force is used too; `feedback_lag` [s].
    Raises InputError where the channel explains the motion in another unit only.
    """
    if recording.ground is None:
        return ShownGround()
    if recording.duration * structure.frequency < _FEWEST_PERIODS:
        return ShownGround(notes=(_TOO_SHORT,))
    force = recording.force / mass if recording.force is not None and mass is not None else None
    ground = recording.ground

    def read(reading: _Reading) -> Identification:
        return identify(
            recording.command,
            recording.measured,
            np.asarray(reading.factor * ground),
            recording.time_step,
            structure,
            force=force,
            feedback_lag=feedback_lag,
            absolute=reading.absolute,
        )

    signs = {_Reading(factor=1.0): (), _Reading(factor=-1.0): (_SIGN_NOTE,)}
    identifications = {reading: read(reading) for reading in signs}
    best = min(identifications, key=lambda reading: identifications[reading].misfit)
    if _is_explained(identifications[best], structure):
        return ShownGround(identified=identifications[best], notes=signs[best], sign=best.factor)
    other_identifications = {reading: read(reading) for reading in _other_readings()}
    explained_readings = [
        reading
        for reading in other_identifications
        if _is_explained(other_identifications[reading], structure)
    ]
    if not explained_readings:
        doubt = _other_ground(identifications[best], structure, has_force=force is not None)
        return ShownGround(notes=(doubt.finding,), doubts=(doubt,))
    likely = min(explained_readings, key=lambda reading: other_identifications[reading].misfit)
    if likely.absolute:
        return ShownGround(notes=(_ABSOLUTE,))
    raise other_unit_of_ground(recording, abs(likely.factor))


def require_unit_of_force(
    recording: Recording, structure: Structure, *, mass: float, feedback_lag: float
) -> None:
    """Refuse a force in another unit than stated, by the equation of motion of the computer's part.

    Whatever the specimen does; `mass` of the structure [kg], `feedback_lag` [s].
    """
    if recording.ground is None or recording.force is None:
        return
    kernel, w0 = Kernel.from_frequency(structure.frequency, recording.time_step), structure.circular_frequency
    x, v, a = (kernel.smooth_derivative(recording.command, order) for order in range(3))
    computed_acceleration = (
        a + 2.0 * structure.damping_ratio * w0 * v + (1.0 - structure.experimental_fraction) * w0**2 * x
    )
    late = kernel.smooth_derivative(recording.force, 0) - feedback_lag * kernel.smooth_derivative(
        recording.force, 1
    )
    columns = np.stack([late / mass, np.ones(late.size)])
    shaken = kernel.smooth_derivative(recording.ground, 0)
    for required_acceleration in (
        -computed_acceleration - shaken,
        -computed_acceleration + shaken,
    ):  # also where the ground acceleration is reversed
        (factor, _), _, residual = fit_equation(columns, required_acceleration, kernel)
        if (
            np.linalg.norm(residual) <= _LARGEST_MISFIT * np.linalg.norm(required_acceleration)
            and factor > 0.0
        ):
            ratio = 1.0 / float(factor)
            if unit_like(ratio, tolerance=_SAME_FORCE):
                raise other_unit_of_force(ratio, recording.name)


def other_unit_of_ground(recording: Recording | CoupledRecording, factor: float) -> InputError:
    """Ask for the unit of a ground acceleration that explains the motion times a factor."""
    channel = next(
        (candidate for candidate in recording.channels if candidate.part is Part.GROUND and candidate.unit),
        None,
    )
    stated_unit, size = ("m/s2", 1.0) if channel is None else (channel.unit, abs(channel.factor))
    matching_units = (
        unit
        for unit, unit_size in UNITS_OF_GROUND.items()
        if abs(factor * size / unit_size - 1.0) < _SAME_UNIT
    )
    unit = next(matching_units, None)
    description = f"one in {unit}" if unit else f"one that is {significant(factor, 4)} times as large"
    ask = f"Is it in {unit}? State that in" if unit else "State its unit in"
    return InputError(
        "The ground acceleration does not fit its unit",
        value=f"{stated_unit}, while the motion of the test is that of {description}",
        remedy=f"{ask} the column's name, ground_acceleration [{unit or 'm/s2'}], or in a file "
        "`channels.toml`",
        where=recording.name,
    )


def require_unit_of_ground(recording: Recording | CoupledRecording, factor: float | None) -> None:
    """Refuse a ground acceleration whose response is that of the test in another unit.

    `factor`: by which it explains the test; None where it does as it is, or not at all.
    """
    for size in _factors_of_units():
        if factor is not None and abs(abs(factor) / size - 1.0) < _UNIT_TOLERANCE:
            raise other_unit_of_ground(recording, size)


def _factors_of_units() -> Iterator[float]:
    """Give factors of channels whose unit is another one than stated."""
    for size in UNITS_OF_GROUND.values():
        yield from (size, 1.0 / size) if size != 1.0 else ()


def _other_readings() -> Iterator[_Reading]:
    for sign in (1.0, -1.0):
        yield _Reading(factor=sign, absolute=True)
        for factor in _factors_of_units():
            yield _Reading(factor=sign * factor)
            yield _Reading(factor=sign * factor, absolute=True)


def _is_explained(identification: Identification, structure: Structure) -> bool:
    """Whether a reading explains the motion by a structure like the stated one."""
    frequency_error = abs(identification.frequency.value / structure.frequency - 1.0)
    return identification.misfit <= _LARGEST_MISFIT and frequency_error <= _FARTHEST


def _other_ground(best: Identification, structure: Structure, *, has_force: bool) -> Contradiction:
    """Say that the channel does not belong to the test."""
    if best.misfit <= _LARGEST_MISFIT:
        reason = (
            f"with it the structure would have {significant(best.frequency.value)} Hz, and "
            f"{significant(structure.frequency)} Hz was stated"
        )
    else:
        share = percent(best.misfit, decimals=0)
        reason = f"the equation of motion leaves {share} of it unexplained"
    clause = ", or the recorded force is not what acted" if has_force else ""
    return Contradiction(
        finding=f"The recorded ground acceleration does not belong to this test{clause}, or the structure is "
        f"not as stated: {reason}. Nothing was learned from it.",
        remedy=_REMEDY,
    )


def doubts_of_ground(recording: Recording, structure: Structure, mass: float) -> tuple[str, ...]:
    """Say whether the recorded ground acceleration is reversed, in another unit, or not this test's.

    `mass` [kg].
    """
    too_short = recording.duration * structure.frequency < _FEWEST_PERIODS
    try:
        return () if too_short else examine_ground(recording, structure, mass=mass, feedback_lag=0.0).notes
    except InputError as error:
        return (f"{error.rule}; found {error.value}. {error.remedy}.",)
