"""Recorded forces that cannot be the specimen's: reversed, in another unit, unrelated, of another column.

A passive specimen resists: its force is a sum of spring, dashpot, mass, hardening and elastic-plastic springs
and masses on springs of their own, with coefficients that are not negative. Such a sum explains a reversed
force only with its sign turned, and a motion does no work against it; and where it explains the force by the
command, not by the measured displacement, the columns are exchanged.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Self

import numpy as np
import scipy

from reliab.assessment.rebuilt_error.specimen_check import slider_elongation, swinging_masses
from reliab.assessment.tracking_index import is_noisier
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import percent, significant
from reliab.core.stated_value import StatedValue
from reliab.recordings.behaviour import remove_spikes
from reliab.recordings.recording import Recording
from reliab.signals.cubic_path import CubicPath
from reliab.signals.spectra import convolve_valid, detrend
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

_FEWEST_SAMPLES = 32  # of the smoothed histories
_UNRELATED_POWER = 0.9  # of the force's power, above which it follows no motion
_BETTER = 0.5  # of what the other explanation leaves over: one is clearly better
_FAR_BETTER = 0.01  # where the force follows the displacement as that of a spring does
_EXPLAINED_POWER = 0.05  # of the force's power left over, below which a force may be that of the specimen
_EXCHANGED_POWER = 0.04  # of the power left over: the force is five times nearer to the command
_SKEW_SAMPLES = 1.2  # samples: a lead that may be the skew of two channels
_LEAD_POWER = 0.25  # of the power that a force which follows the command leaves over, seen from ahead of it
_REALIGNED_SHARE = 0.25  # of what is left over, by the same displacement without its lead
_SPRING = 0.5  # correlation of force and displacement above which a stiffness is known
_YIELDS = (0.02, 0.1, 0.25, 0.5)  # of the largest displacement, where an elastic-plastic spring slips
_STIFFNESSES = (0.01, 3.0)  # over the stated one, of a specimen that may yield
_OPEN_STIFFNESSES = (0.01, 100.0)  # the same where the unit is known, or what is stated is a first value only
_STRAIGHT, _LINEAR_STIFFNESSES = (
    0.95,
    (0.5, 2.0),
)  # correlation with the displacement, and the same of a linear one
_AGREES = 0.1  # of the stiffness, by which mass, frequency, share and force may be off
_UNIT_TOLERANCE = 0.25
_SAME_UNIT, _SAME_UNIT_FITTED = 0.1, 0.03  # of a stated stiffness, and of one that is a first value only
_UNITS: Final = {
    1e6: "meganewtons for newtons, or newtons for meganewtons",
    1e3: "kilonewtons for newtons, or newtons for kilonewtons",
    9806.65: "tonnes-force for newtons, or newtons for tonnes-force",
    4448.2216: "kips for newtons, or newtons for kips",
    9.80665: "kilograms-force for newtons, or newtons for kilograms-force",
    4.4482216: "pounds-force for newtons, or newtons for pounds-force",
    39.370079: "inches for metres, or metres for inches",
}


def require_restoring_force(
    measured_displacement: Array,
    force: Array,
    time_step: float,
    *,
    stiffness: float | None = None,
    linear: bool = False,
    is_stiffness_fitted: bool = False,
    is_unit_stated: bool = False,
    name: str = "",
) -> "ExaminedForce | None":
    """Refuse a force that is surely reversed, stands still, follows no motion, or is in another unit.

    Returns the examined force, None where the test is too short to tell.

    `measured_displacement` displacement [m], without spikes, and `force` [N], shape (n,); `time_step` [s];
    `stiffness`: stated one of the specimen [N/m], without which the unit is not examined; `linear`: whether
    the specimen is taken as linear; `is_stiffness_fitted`: whether its stiffness is fitted, so that the unit
    alone counts; `is_unit_stated`: whether the force has a stated unit, so that a specimen that is not linear
    may be as stiff as a damper beside a weak spring; `name`: what the test is called.

    >>> time = np.arange(0.0, 20.0, 0.005)
    >>> moved = np.sin(6.0 * time) * np.sin(0.15 * time)
    >>> examined = require_restoring_force(moved, 40.0 * moved, 0.005, stiffness=40.0)
    >>> require_restoring_force(moved, -40.0 * moved, 0.005)
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: The recorded force does not resist the motion; found a force that acts
    along it, as if its sign were reversed. Reverse the sign of the force: it is positive where the specimen
    is pushed in the positive direction.
    """
    _require_change(force, name)
    examined = ExaminedForce.from_histories(measured_displacement, force, time_step)
    if examined is None:
        return None
    if examined.reverse_explains and not examined.may_be_right:
        raise _reversed_force(name)
    if examined.unexplained > _UNRELATED_POWER:
        raise InputError(
            "The recorded force does not follow the measured displacement",
            value=f"a force of whose power {percent(examined.unexplained, decimals=0)} follows no spring, "
            "dashpot, mass or friction",
            remedy="Check that the force is the specimen's, and that the load cell was connected",
            where=name,
        )
    if stiffness:
        straight, slope = examined.stiffness_above(_STRAIGHT) is not None, examined.stiffness
        is_open = is_stiffness_fitted or (is_unit_stated and not straight and not linear)
        if slope is not None:
            _require_ratio(slope / stiffness, name, straight=straight, linear=linear, is_open=is_open)
    return examined


def require_stated_forces(recording: Recording, partition: Partition, to_interface: Array) -> None:
    """Refuse forces of several actuators that are reversed, stand still or are in another unit.

    Each is compared with that of the stated springs, which all displacements of the interface strain;
    `to_interface`: interface displacements of unit displacements of the actuators [-], shape (p, p).
    """
    if recording.force is None:
        return
    stiffness = to_interface.T @ partition.specimen_stiffness @ to_interface
    for number, force, row in zip(
        recording.actuators, recording.force, stiffness @ recording.measured, strict=True
    ):
        name = f"{recording.name}, actuator {number}"
        _require_change(force, name)
        resistance, spring = detrend(force), detrend(row)
        work, power = float(resistance @ spring), float(spring @ spring)
        correlation = work / max(float(np.linalg.norm(resistance)) * np.sqrt(power), np.finfo(float).tiny)
        if correlation < -_SPRING:
            raise _reversed_force(name)
        if correlation > _SPRING:
            _require_ratio(work / power, name, straight=correlation > _STRAIGHT)


def _require_change(force: Array, name: str) -> None:
    if not np.ptp(force) > 0.0:
        raise InputError(
            "The recorded force does not change during the test",
            value=f"{force[0]:g} throughout",
            remedy="Check that the load cell was connected, or leave the column out",
            where=name,
        )


def _reversed_force(name: str) -> InputError:
    return InputError(
        "The recorded force does not resist the motion",
        value="a force that acts along it, as if its sign were reversed",
        remedy="Reverse the sign of the force: it is positive where the specimen is pushed in the positive "
        "direction",
        where=name,
    )


_PERIODS_OF_KERNEL = 0.5
_SAMPLES_PER_PERIOD = 24.0  # samples of the equation in a period


@dataclass(frozen=True, kw_only=True, eq=False)
class SmoothingKernel:
    """φ and its first two derivatives, and the sampling of the convolved histories."""

    values: tuple[Array, Array, Array]
    time_step: float
    frequency: float
    every: int

    @classmethod
    def from_frequency(cls, frequency: float, step: float) -> "SmoothingKernel":
        """Make the kernel of half a period of a natural frequency [Hz] for a step [s]."""
        reach = max(round(_PERIODS_OF_KERNEL / (frequency * step)), 8)
        u = np.arange(-reach, reach + 1) / reach
        # φ = (1 − u²)⁶ and its derivatives by u
        flank = 1.0 - u**2
        first = -12.0 * u * flank**5
        second = -12.0 * flank**5 + 120.0 * u**2 * flank**4
        rate = 1.0 / (reach * step)
        return cls(
            values=(flank**6 / reach, first * rate / reach, second * rate**2 / reach),
            time_step=step,
            frequency=frequency,
            every=max(int(1.0 / (_SAMPLES_PER_PERIOD * frequency * step)), 1),
        )

    def smooth_derivative(self, history: Array, order: int) -> Array:
        """Convolve a history with φ⁽ᵏ⁾, which gives its smoothed k-th derivative."""
        return convolve_valid(history, self.values[order])[:: self.every]


@dataclass(frozen=True, kw_only=True, eq=False)
class ExaminedForce:
    """A recorded force beside the motion of a passive specimen that would explain it, or its reverse.

    In motion of one frequency a mass explains a reversed spring, and neither explains a lag or a slip.
    """

    measured_displacement: Array  # measured_displacement, force: Without spikes, shape (n,)
    force: Array
    kernel: SmoothingKernel

    @classmethod
    def from_histories(cls, measured_displacement: Array, force: Array, time_step: float) -> Self | None:
        """Smooth both at the frequency at which they move together; None where the test is too short."""
        kernel = _kernel(measured_displacement, force, time_step)
        if kernel is None:
            return None
        return cls(measured_displacement=measured_displacement, force=force, kernel=kernel)

    @property
    def unexplained(self) -> float:
        """Power left over of the force as recorded, over that of the force [-]."""
        return self._remaining[0]

    @cached_property
    def _remaining(self) -> list[float]:
        """Power left over of the force and of its reverse [-]."""
        return _remaining_power(self.measured_displacement, (self.force, -self.force), self.kernel)

    @cached_property
    def stiffness(self) -> float | None:
        """Stiffness [N/m] of a specimen that springs back; None where it does not."""
        return self.stiffness_above(_SPRING)

    def stiffness_above(self, correlation: float) -> float | None:
        """Stiffness [N/m] where force and displacement are correlated at least so much; else None."""
        displacement, resistance = (
            row - row.mean()
            for row in (
                self.kernel.smooth_derivative(self.measured_displacement, 0),
                self.kernel.smooth_derivative(self.force, 0),
            )
        )
        slope = float(displacement @ resistance) / float(displacement @ displacement)
        size = slope * float(np.linalg.norm(displacement) / np.linalg.norm(resistance))
        return slope if size >= correlation else None

    @cached_property
    def reverse_explains(self) -> bool:
        """Whether the force is explained clearly better with its sign turned."""
        remaining, remaining_reversed = self._remaining
        better = _BETTER if self.stiffness is None else _FAR_BETTER
        explains = remaining_reversed < min(better * remaining, _UNRELATED_POWER)
        return explains and not _takes_work(self.measured_displacement, self.force, self.kernel)

    @property
    def may_be_right(self) -> bool:
        """Whether the force is explained as recorded, too, so that no sign is certain."""
        return self.stiffness is not None and self.unexplained < _EXPLAINED_POWER

    def follows(self, command: Array) -> bool:
        """Whether a command explains the force far better than a measured displacement that is ahead of it.

        A displacement that explains the force, too, is in order: an actuator that leads moves the specimen
        earlier than its command, which a computer knows without noise, and a skew shows as a lead.
        """
        kernel, displacement = self.kernel, self.measured_displacement
        lead = _lead(displacement, command, kernel)
        lead_power = (
            lead**2
            * _power(kernel.smooth_derivative(displacement, 1))
            / _power(kernel.smooth_derivative(displacement, 0))
        )
        misses = lead > _SKEW_SAMPLES * kernel.time_step and self.unexplained > _LEAD_POWER * lead_power
        if not misses:
            return False
        return _remaining_power(command, (self.force,), kernel)[0] < _EXCHANGED_POWER * self.unexplained


def doubts_of_force(recording: Recording, examined: ExaminedForce | None = None) -> Iterator[str]:
    """Say where sign or columns of a recorded force may be wrong, though that is not certain.

    `examined`: its force, if that was examined before.
    """
    clean, *_ = remove_spikes(recording)
    if examined is None and clean.force is not None and not clean.has_several:
        examined = ExaminedForce.from_histories(clean.measured, clean.force, clean.time_step)
    if examined is None:
        return
    yield from doubts_of_sign(examined)
    if examined.follows(clean.command):
        yield (
            "The recorded force follows the command more closely than the measured displacement. Check the "
            "displacement sensor (drift, stroke, clock), and that the two columns are not exchanged."
        )


def doubts_of_sign(examined: ExaminedForce) -> Iterator[str]:
    """Say where a force that a spring explains is explained better with its sign turned."""
    if examined.reverse_explains:
        yield (
            "The recorded force is that of a mass with its sign turned, as the restoring force of a free "
            "vibration is. Check its sign: it is positive where the specimen resists a positive displacement."
        )


def _takes_work(measured_displacement: Array, force: Array, kernel: SmoothingKernel) -> bool:
    """Whether the motion does work on the specimen, on average over the test, as on one that buckles."""
    displacement, resistance = (
        kernel.smooth_derivative(history, 0) for history in (measured_displacement, force)
    )
    resistance = resistance - resistance.mean()
    work = np.cumsum(0.5 * (resistance[1:] + resistance[:-1]) * np.diff(displacement))
    return bool(work.mean() > 0.0)


def require_order(command: Array, examined: ExaminedForce, name: str = "") -> None:
    """Refuse a test whose force follows the command, and whose measured displacement is only ahead of it.

    A force that follows the command is no proof: a displacement sensor that drifts hides the motion that the
    specimen follows. Where the columns are exchanged, the displacement explains the force as soon as its lead
    is taken off, and the command, which is then a reading, is no cleaner than the displacement.

    `command` [m], shape (n,).
    """
    if not examined.follows(command):
        return
    kernel, displacement = examined.kernel, examined.measured_displacement
    path = CubicPath.interpolate(np.arange(displacement.size) * kernel.time_step, displacement)
    realigned = path.read_delayed(_lead(displacement, command, kernel))
    power_realigned = _remaining_power(realigned, (examined.force,), kernel)[0]
    if power_realigned < _REALIGNED_SHARE * examined.unexplained and not is_noisier(displacement, command):
        raise InputError(
            "The recorded force does not follow the measured displacement",
            value="a force that follows the command instead, as if the two columns were exchanged",
            remedy="Exchange the columns, or name them with `command` and `measured`",
            where=name,
        )


def _lead(first: Array, second: Array, kernel: SmoothingKernel) -> float:
    """Time by which one history is ahead of another, to first order [s]."""
    ahead, rate = detrend(kernel.smooth_derivative(first, 0)), kernel.smooth_derivative(second, 1)
    return float(ahead @ rate) / float(rate @ rate)


def _power(values: Array) -> float:
    return float(np.var(values))


def remark_on_force(
    examined: ExaminedForce, structure: Structure, stated_values: Mapping[str, StatedValue]
) -> str:
    """Say that a force differs from what is stated of a linear specimen, or which mass it belongs to.

    Empty where there is nothing to say.
    """
    per_mass = structure.experimental_fraction * structure.circular_frequency**2
    stated_mass = stated_values.get("mass")
    stiffness = examined.stiffness_above(_SPRING if stated_mass is None else _STRAIGHT)
    if stiffness is None:
        return ""
    if stated_mass is None:
        return (
            "The unit of the recorded force was not checked: in newtons it implies a mass of "
            f"{significant(stiffness / per_mass)} kg. Give `mass` to verify it."
        )
    share = stiffness / (stated_mass.value * per_mass)
    if abs(share - 1.0) <= _AGREES:
        return ""
    return (
        f"The recorded force is {percent(share, decimals=0)} of what mass, frequency and share make of the "
        "measured displacement. Check them, and the scale of the force."
    )


def _require_ratio(
    ratio: float, name: str, *, straight: bool, linear: bool = False, is_open: bool = False
) -> None:
    """Refuse a stiffness over the stated one that another unit makes, or no specimen has.

    `is_open`: whether the stiffness itself may be any.
    """
    # a specimen of which only the force is known may have another stiffness, but hardly that of a unit
    near = _SAME_UNIT_FITTED if is_open else _SAME_UNIT
    exact = straight and not linear and bool(unit_like(ratio, tolerance=near))
    stiffness_range = _OPEN_STIFFNESSES if is_open else _STIFFNESSES
    least, largest = _LINEAR_STIFFNESSES if exact or (straight and linear) else stiffness_range
    if not least <= ratio <= largest:
        raise other_unit_of_force(
            ratio, name, is_learnable=linear and _STIFFNESSES[0] <= ratio <= _STIFFNESSES[1]
        )


def other_unit_of_force(ratio: float, name: str, *, is_learnable: bool = False) -> InputError:
    """Ask for the unit of a force that is a ratio of what the stated specimen makes.

    `is_learnable`: whether it may be that of a specimen that softened or hardened so much.
    """
    unit = unit_like(ratio, tolerance=_UNIT_TOLERANCE)
    otherwise = ". If it softened or hardened so much, state `specimen` as measured" if is_learnable else ""
    comparison = f", as {unit} would have" if unit else ""
    return InputError(
        "The recorded force does not fit the stated specimen",
        value=f"a stiffness of {significant(ratio)} times the stated one{comparison}",
        remedy="State the unit of the force in the column's name, such as force [lbf], or check mass, "
        f"frequency and share of the specimen{otherwise}",
        where=name,
    )


def unit_like(ratio: float, *, tolerance: float) -> str:
    """Say which exchange of units a ratio of stiffnesses looks like, "" if none.

    `tolerance`: of the ratio [-].

    >>> unit_like(0.2248, tolerance=0.02)
    'pounds-force for newtons, or newtons for pounds-force'
    >>> unit_like(2.0, tolerance=0.02)
    ''
    """
    both = ((words, unit_ratio) for factor, words in _UNITS.items() for unit_ratio in (factor, 1.0 / factor))
    return next((words for words, unit_ratio in both if abs(ratio / unit_ratio - 1.0) < tolerance), "")


def _kernel(measured_displacement: Array, force: Array, time_step: float) -> SmoothingKernel | None:
    """Make the kernel for the frequency at which force and displacement move together; None if too short."""
    common = np.abs(
        np.fft.rfft(force - force.mean()) * np.fft.rfft(measured_displacement - measured_displacement.mean())
    )
    number = np.arange(common.size)
    frequency = float(number[np.argmax(number * common)]) / (measured_displacement.size * time_step)
    kernel = SmoothingKernel.from_frequency(frequency, time_step)
    samples = (measured_displacement.size - kernel.values[0].size) // kernel.every
    return kernel if samples >= _FEWEST_SAMPLES else None


def _remaining_power(displacement: Array, forces: Sequence[Array], kernel: SmoothingKernel) -> list[float]:
    """Power that the elements of a passive specimen leave over of each force, over that of the force [-]."""
    shape = displacement / float(np.abs(displacement).max())
    bent = [shape**3, *(slider_elongation(shape, limit) for limit in _YIELDS)]
    acceleration = np.gradient(np.gradient(displacement, kernel.time_step), kernel.time_step)
    swinging = swinging_masses(acceleration, kernel.time_step, kernel.frequency)
    rows = [
        *(kernel.smooth_derivative(displacement, order) for order in range(3)),
        *(kernel.smooth_derivative(row, 0) for row in [*bent, *swinging]),
    ]
    terms = np.stack([row - row.mean() for row in rows], axis=1)
    terms /= np.linalg.norm(terms, axis=0)
    targets = [
        resistance - resistance.mean()
        for resistance in (kernel.smooth_derivative(force, 0) for force in forces)
    ]
    unit_targets = [target / float(np.linalg.norm(target)) for target in targets]
    return [float(scipy.optimize.nnls(terms, target)[1] ** 2) for target in unit_targets]
