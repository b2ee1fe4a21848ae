"""Recorded ground accelerations as the motion of the test shows them.

The equation of motion is fitted with the channel as it is recorded and reversed; where neither explains the
motion, in other units, and for one mass as its absolute acceleration.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, TypeVar

import numpy as np

from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.evidence import main_frequency
from reliab.assessment.inference.structure_response import apply_at_interface, respond
from reliab.assessment.recorded_force import SmoothingKernel, other_unit_of_force, unit_like
from reliab.assessment.verdict import Contradiction
from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.recordings.behaviour import remove_spikes
from reliab.recordings.recording import Part, Recording
from reliab.structures.partition import Partition, whole_structure
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
"""Largest share of the ground's forces that is not explained; above it the channel is of another test."""

_FARTHEST = 0.25  # of the stated frequency, by which an identified one may differ
_SAME_FORCE = 0.2
_SAME_UNIT = 0.05  # of a unit, by which a calibrated channel may differ from it
_FEWEST_PERIODS = 5.0
_REACH = 2.0  # times the main frequencies of the motion, up to which it is compared
_STEPS = 4
_LARGEST_STEP = 0.15
_CHANGE = 1e-3  # by which frequencies and damping ratios are changed
_PRIORS = np.array([0.1, 0.3])  # standard deviations of their factors before the test
_LEFT_OPEN = 0.004  # of the frequency, one standard deviation: what scales and clocks are taken for
_NEAR = 2.0  # factor between the best factor of a channel and that of its unit
_TOO_SHORT = "The test is too short for its structure to be identified from the recorded ground acceleration."
_AT_ZERO = "The recorded ground acceleration is zero throughout. Nothing was learned from it."
_SIGN_NOTE = "The ground acceleration has the opposite sign."
_ABSOLUTE = (
    "The channel of the ground acceleration is not this test's ground acceleration: it moves as the absolute "
    "acceleration of the structure does, that of ground and response together. Nothing was learned from it. "
    "Record the acceleration of the ground."
)
_REMEDY = "Check channel, unit and range of the ground acceleration, and the description of the structure."


_Channel = TypeVar("_Channel", Array, Spectrum)


@dataclass(frozen=True, kw_only=True)
class ShownGround:
    """What a recorded ground acceleration shows."""

    fits: bool = False  # Whether it explains the motion of the test by a structure like the stated one
    sign: float = 1.0  # −1 where the channel has the opposite sign
    # frequency, deviation: Natural frequencies with which it does so best over those stated, and their
    # standard deviation [-]
    frequency: float = 1.0
    deviation: float = 0.0
    misfit: float | None = None  # Share that it does not explain [-]; None where it was not compared
    notes: tuple[str, ...] = ()  # What was found about the channel, in sentences
    doubts: tuple[Contradiction, ...] = ()  # Where it contradicts the test
    unit_factor: float = (
        1.0  # By which it would explain the motion, where its unit is another one than stated
    )

    def evidence(self, ground: _Channel | None, *, needs_fit: bool = True) -> _Channel | None:
        """Return the ground acceleration of the test [m/s²], None where its channel is no evidence.

        With `needs_fit` a channel that the structure does not explain is none.
        """
        return self.sign * ground if ground is not None and (self.fits or not needs_fit) else None


def examine_ground(
    channels: ChannelSpectra,
    structure: Partition,
    *,
    duration: float,
    feedback_lag: float,
) -> ShownGround:
    """Compare a test with its recorded ground acceleration, or say why that cannot be this test's.

    Where that of the specimen as stated does not explain the motion, a recorded force among the `channels`
    takes its place; `duration`, `feedback_lag` [s].
    """
    if channels.ground is None:
        return ShownGround()
    lowest, moves = float(structure.natural_frequencies[0]), bool(np.any(channels.ground))
    if not moves or duration * lowest < _FEWEST_PERIODS:
        return ShownGround(notes=(_TOO_SHORT if moves else _AT_ZERO,))
    linear = _GroundFit(channels=channels, structure=structure, feedback_lag=feedback_lag)
    readings = [linear] if channels.force is None else [linear, replace(linear, by_force=True)]
    fits = [replace(reading, factor=sign).fit() for reading in readings for sign in (1.0, -1.0)]
    for fit in sorted(fits, key=lambda fit: (fit.by_force, fit.misfit)):
        if fit.is_explained:
            return fit.shown(*() if fit.factor > 0.0 else (_SIGN_NOTE,))
    best = min(fits[:2], key=lambda fit: fit.misfit)
    if structure.size == 1:
        readings += [replace(reading, absolute=True) for reading in readings]
    likely = min(
        (fit for reading in readings for fit in reading.fits_in_units() if fit.is_explained),
        key=lambda fit: fit.misfit,
        default=None,
    )
    if likely is None:
        doubt = _other_ground(best, lowest, has_force=channels.force is not None)
        return replace(best.shown(doubt.finding), doubts=(doubt,))
    if likely.absolute:
        return best.shown(_ABSOLUTE)
    return replace(best.shown(), unit_factor=abs(likely.factor))


@dataclass(frozen=True, kw_only=True, eq=False)
class _GroundFit:
    """A way to read the channel, and the structure with which it explains the motion best.

    The forces that keep the interface moving as commanded, less those of the specimen, are those that the
    ground acceleration causes there. Frequencies and damping ratios, all by one factor each, are fitted until
    they are (Gauss and Newton), over time and frequency (see `inference.evidence`).
    """

    channels: ChannelSpectra
    structure: Partition
    feedback_lag: float  # [s]
    factor: float = 1.0  # To m/s², with its sign [-]
    absolute: bool = False  # Whether it is the absolute acceleration
    by_force: bool = False  # Whether the specimen's force is the recorded one, which shows no frequency
    frequency: float = 1.0  # frequency, damping_ratio: factors of all [-]
    damping_ratio: float = 1.0
    deviation: float = 0.0  # Of the factor of frequency [-]

    @property
    def is_explained(self) -> bool:
        """Whether this reading explains the motion by a structure like the stated one."""
        return self.misfit <= _LARGEST_MISFIT and abs(self.frequency - 1.0) <= _FARTHEST

    def shown(self, *notes: str) -> ShownGround:
        """Say what this reading shows."""
        return ShownGround(
            fits=self.is_explained,
            sign=self.factor,
            frequency=self.frequency,
            deviation=self.deviation,
            misfit=self.misfit,
            notes=notes,
        )

    def fit(self) -> "_GroundFit":
        """Fit the structure."""
        fit = self
        for _ in range(_STEPS):
            residual = fit.residual
            columns = np.stack(
                [
                    (replace(fit, frequency=fit.frequency * (1.0 + _CHANGE)).residual - residual) / _CHANGE,
                    (replace(fit, damping_ratio=fit.damping_ratio * (1.0 + _CHANGE)).residual - residual)
                    / _CHANGE,
                ]
            )
            power = max(float(np.mean(residual**2)), np.finfo(float).tiny)
            columns[0] *= not fit.by_force
            covariance = np.linalg.inv(columns @ columns.T / power + np.diag(_PRIORS**-2.0))
            change = np.clip(-covariance @ columns @ residual / power, -_LARGEST_STEP, _LARGEST_STEP)
            fit = replace(
                fit,
                frequency=fit.frequency * (1.0 + float(change[0])),
                damping_ratio=fit.damping_ratio * (1.0 + float(change[1])),
                deviation=float(np.hypot(np.sqrt(covariance[0, 0]), _LEFT_OPEN)),
            )
        return fit

    def fits_in_units(self) -> Iterator["_GroundFit"]:
        """Fit with the factors of other units that are near the best one, and of an absolute one as it is."""
        required_forces, caused_forces = self.forces
        likely = -float(required_forces @ caused_forces) / float(caused_forces @ caused_forces)
        for size in (*_factors_of_units(), *([1.0] if self.absolute else [])):
            if 1.0 / _NEAR < abs(likely) / size < _NEAR:
                yield replace(self, factor=float(np.copysign(size, likely))).fit()

    @cached_property
    def misfit(self) -> float:
        """RMS of what is not explained over that of the ground's forces, each weighted by their power.

        After a short pulse only the sensors' noise is left, of which the ground explains nothing.
        """
        power = (self.factor * self.forces[1]) ** 2
        total = float(power @ power)
        return float(np.sqrt(power @ self.residual**2 / total)) if total > 0.0 else np.inf

    @cached_property
    def residual(self) -> Array:
        required_forces, caused_forces = self.forces
        return np.asarray(required_forces + self.factor * caused_forces)

    @cached_property
    def forces(self) -> tuple[Array, Array]:
        """Forces that the motion asks of the ground, and those that its acceleration causes.

        At all interface displacements, over the size of the specimen's, over time and frequency, shape (m,).
        """
        channels, command = self.channels, self.channels.interface_command
        ground = channels.ground
        if ground is None:
            raise AssertionError  # only a recorded one is compared
        structure = self.structure.scale(frequency=self.frequency, damping_ratio=self.damping_ratio)
        response = respond(structure, channels.band)
        borne = apply_at_interface(response.impedance, command)
        if self.by_force and channels.force is not None:
            acting = channels.force_at_interface(channels.force)
        else:
            acting = apply_at_interface(response.impedance, channels.to_interface @ channels.measured)
        acting = acting * channels.band.advance(-self.feedback_lag)
        required_forces = apply_at_interface(response.stiffness, command) - borne + acting
        if self.absolute:
            required_forces = required_forces - response.ground_load.T * channels.band.s**2 * command
        highest = _REACH * max(float(self.structure.natural_frequencies[0]), main_frequency(channels))
        required_cells, caused_cells, borne_cells = (
            channels.cells(forces, highest)
            for forces in (required_forces, response.ground_load.T * ground, borne)
        )
        size = np.sqrt(np.mean(borne_cells**2, axis=(1, 2), keepdims=True))
        return (required_cells / size).ravel(), (caused_cells / size).ravel()


def require_unit_of_force(
    recording: Recording, structure: Structure, *, mass: float, feedback_lag: float
) -> None:
    """Refuse a force in another unit than stated, by the mass that it would belong to.

    `mass` of the structure [kg], `feedback_lag` [s].
    """
    shown = mass_from_ground(recording, structure, feedback_lag=feedback_lag)
    if shown is not None and unit_like(shown / mass, tolerance=_SAME_FORCE):
        raise other_unit_of_force(shown / mass, recording.name)


def mass_from_ground(recording: Recording, structure: Structure, *, feedback_lag: float) -> float | None:
    """Mass [kg] for which force and ground acceleration fit the computer's part, whatever the specimen does.

    None where either was not recorded, or they do not explain the command; `feedback_lag` [s].
    """
    is_short = recording.duration * structure.frequency < _FEWEST_PERIODS
    if recording.ground is None or recording.force is None or is_short:
        return None
    command = remove_spikes(recording)[0].command
    kernel = SmoothingKernel.from_frequency(structure.frequency, recording.time_step)
    w0 = structure.circular_frequency
    x, v, a = (kernel.smooth_derivative(command, order) for order in range(3))
    computed_acceleration = (
        a + 2.0 * structure.damping_ratio * w0 * v + (1.0 - structure.experimental_fraction) * w0**2 * x
    )
    late = kernel.smooth_derivative(recording.force, 0) - feedback_lag * kernel.smooth_derivative(
        recording.force, 1
    )
    columns = np.stack([late, np.ones(late.size)], axis=1)
    shaken = kernel.smooth_derivative(recording.ground, 0)
    for sign in (1.0, -1.0):  # a reversed ground acceleration is told elsewhere
        required_acceleration = -computed_acceleration - sign * shaken
        values = np.linalg.lstsq(columns, required_acceleration, rcond=None)[0]
        unexplained = np.linalg.norm(required_acceleration - columns @ values)
        if unexplained <= _LARGEST_MISFIT * np.linalg.norm(required_acceleration) and values[0] > 0.0:
            return 1.0 / float(values[0])
    return None


def refusal_of_unit(shown: ShownGround, recording: Recording) -> InputError | None:
    """Ask for the unit of a ground acceleration that explains the motion in another one only."""
    factor = shown.unit_factor
    if factor == 1.0:
        return None
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


def _factors_of_units() -> Iterator[float]:
    """Give factors of channels whose unit is another one than stated."""
    for size in UNITS_OF_GROUND.values():
        yield from (size, 1.0 / size) if size != 1.0 else ()


def _other_ground(best: _GroundFit, lowest: float, *, has_force: bool) -> Contradiction:
    """Say that the channel does not belong to the test; `lowest`: natural frequency as stated [Hz]."""
    if best.misfit <= _LARGEST_MISFIT:
        reason = (
            f"with it the structure would have {significant(best.frequency * lowest)} Hz, and "
            f"{significant(lowest)} Hz was stated"
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
    if recording.duration * structure.frequency < _FEWEST_PERIODS:
        return ()
    channels = ChannelSpectra.from_channels(
        recording.command[np.newaxis],
        recording.measured[np.newaxis],
        recording.time_step,
        whole_structure(structure),
        ground=recording.ground,
        force=None if recording.force is None else recording.force[np.newaxis] / mass,
    )
    shown = examine_ground(
        channels, whole_structure(structure), duration=recording.duration, feedback_lag=0.0
    )
    error = refusal_of_unit(shown, recording)
    return shown.notes if error is None else (f"{error.rule}; found {error.value}. {error.remedy}.",)
