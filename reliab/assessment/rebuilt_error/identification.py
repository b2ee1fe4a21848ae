"""The structure's parameters, estimated from the test by the loop's equation of motion.

The command solves the numerical substructure's equation of motion for the recorded ground acceleration and
the force per unit mass p that was fed back ::

    x_c'' + c x_c' + k x_c + p(t − τ) = −a_g,   c = 2ξω₀,   k = (1 − α)ω₀²

With the force recorded, c and k follow from least squares, and ω₀² = k + αω₀² with αω₀² the specimen's
stiffness from the force and the measured displacement (`fit_spring`). Without a force the specimen is
taken as linear in the measured displacement, p = αω₀²x_m, and the equation gives c and ω₀² for the stated α.
A force that comes late by τ acts as a damping ratio of −αω₀τ/2 (expand p(t − τ)): only their combined effect
can be identified, so that each is estimated for the stated value of the other.

A measured displacement that was recorded late by s against the command acts as a damping ratio of αω₀s/2, so
that skew and damping ratio cannot be told apart either; with the force in the equation, its skew takes the
place of the displacement's.

Nothing is differentiated. Each history is convolved with a smooth kernel φ of finite length, and the
derivatives are put on the kernel (weak form: Messenger and Bortz 2021, Multiscale Model. Simul. 19, eq.
2.3); the beginning of the test does not matter.

A linear specimen's force is f = k x + c x'. Where the displacement was recorded late by s against the force,
x(t) = x_r(t + s), the force is k x_r + k s x_r' to first order. Thus c/k is a time, and whether it is a skew
between the two channels, a dashpot in the specimen or a force that comes late (c/k < 0), they cannot tell.
"""

from dataclasses import dataclass

import numpy as np

from reliab.assessment.rebuilt_error.kernel import Kernel, fit_equation
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.structures.structure import Structure

_CLEAR = 10.0  # standard errors: a stiffness that is less certain is none

_FEWEST_PERIODS = 4.0
_LEAST_STIFFNESS = 1e-6  # of the stated ω₀², where an equation finds none, or less
_SIGNIFICANT = 3.0  # standard errors
_MATTERS = {"frequency": 0.005, "damping_ratio": 0.02, "experimental_fraction": 0.02, "feedback_lag": 1e-4}


@dataclass(frozen=True, kw_only=True)
class Spring:
    """A specimen's spring by its recorded force."""

    # stiffness, stiffness_deviation: k with its standard error, in units of force over metres
    stiffness: float
    stiffness_deviation: float
    # late, late_deviation: c/k with its standard error [s]: time by which the displacement was recorded later
    # than the force
    late: float
    late_deviation: float


def fit_spring(measured_displacement: Array, force: Array, kernel: Kernel) -> Spring:
    """Fit k and c to a recorded force.

    `measured_displacement` [m].

    >>> time = np.arange(0.0, 30.0, 0.005)
    >>> force = 40.0 * np.sin(6.0 * time) * np.sin(0.1 * time)
    >>> recorded = np.sin(6.0 * (time - 0.002)) * np.sin(0.1 * (time - 0.002))
    >>> spring = fit_spring(recorded, force, Kernel.from_frequency(1.0, 0.005))
    >>> round(spring.stiffness, 2), round(1e3 * spring.late, 3)
    (40.0, 2.0)
    """
    columns = np.stack(
        [
            kernel.smooth_derivative(measured_displacement, 0),
            kernel.smooth_derivative(measured_displacement, 1),
        ]
    )
    columns = np.vstack([columns, np.ones(columns.shape[1])])
    (stiffness, damping, _), covariance, _ = fit_equation(columns, kernel.smooth_derivative(force, 0), kernel)
    follows = stiffness > _CLEAR * np.sqrt(covariance[0, 0])
    return Spring(
        stiffness=float(stiffness),
        stiffness_deviation=float(np.sqrt(covariance[0, 0])),
        late=float(damping / stiffness) if follows else 0.0,
        late_deviation=float(np.sqrt(covariance[1, 1]) / stiffness) if follows else 0.0,
    )


@dataclass(frozen=True, kw_only=True)
class IdentifiedParameter:
    """A parameter estimated from the test, together with its stated value."""

    value: float  # value, deviation: Value and standard error, in the parameter's own unit (Hz, -, s)
    deviation: float
    stated: float  # What the user stated

    def departs(self, least: float) -> bool:
        """Whether the stated value is wrong by three standard errors and by more than `least`."""
        off = abs(self.value - self.stated)
        return off > _SIGNIFICANT * self.deviation and off > least


@dataclass(frozen=True, kw_only=True)
class Identification:
    """Parameters of the structure by the loop's equation of motion."""

    # frequency, damping_ratio: f [Hz], and ξ [-] if the stated lag of the fed-back force is right
    frequency: IdentifiedParameter
    damping_ratio: IdentifiedParameter
    # experimental_fraction, feedback_lag: α [-], and the lag of the fed-back force [s] if the stated damping
    # ratio is right; None without a recorded force
    experimental_fraction: IdentifiedParameter | None
    feedback_lag: IdentifiedParameter | None
    # Residual of the equation over the ground acceleration while that acts, both seen through the kernel [-]
    misfit: float

    def disagreements(self) -> tuple[str, ...]:
        """Names of stated values from which the test differs significantly and not negligibly."""
        return tuple(
            name
            for name, least in _MATTERS.items()
            if (estimate := getattr(self, name)) is not None
            and estimate.departs(least if name == "feedback_lag" else least * abs(estimate.stated))
        )


def identify(
    command: Array,
    measured_displacement: Array,
    ground_acceleration: Array,
    time_step: float,
    structure: Structure,
    *,
    force: Array | None = None,
    feedback_lag: float = 0.0,
    absolute: bool = False,
) -> Identification:
    """Estimate frequency, damping ratio, share in the laboratory and feedback lag.

    `command`, `measured_displacement` [m]; `ground_acceleration` [m/s²]; `time_step` [s]; `force` [m/s²];
    `feedback_lag` [s]; `absolute`: whether the acceleration is that of ground and response together.

    >>> from reliab.simulation.hybrid_test.model import HybridTest

    >>> from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
    >>> structure = Structure(frequency=1.0, damping_ratio=0.05)
    >>> time = np.arange(0.0, 20.0, 0.002)
    >>> shaken = np.sin(7.0 * time) * np.exp(-0.2 * time)
    >>> run = run_closed_loop(HybridTest(structure=structure), shaken, 0.002)
    >>> stated = Structure(frequency=1.02, damping_ratio=0.05)
    >>> found = identify(run.command.values[0], run.measured, shaken, 0.002, stated, force=run.force)
    >>> round(found.frequency.value, 3), found.disagreements()
    (1.0, ('frequency',))
    """
    _check(command, measured_displacement, ground_acceleration, force, time_step, structure)
    kernel = Kernel.from_frequency(structure.frequency, time_step)
    command_derivatives = [kernel.smooth_derivative(command, order) for order in range(3)]
    shaken = kernel.smooth_derivative(ground_acceleration, 0) - (command_derivatives[2] if absolute else 0.0)
    if force is None:
        return _identify_without_force(
            command_derivatives, shaken, kernel, structure, feedback_lag, measured_displacement
        )
    return _identify_with_force(
        command_derivatives, shaken, kernel, structure, feedback_lag, force, measured_displacement
    )


def _identify_with_force(
    command_derivatives: list[Array],
    shaken: Array,
    kernel: Kernel,
    structure: Structure,
    stated_lag: float,
    force: Array,
    measured_displacement: Array,
) -> Identification:
    force_seen, force_rate = kernel.smooth_derivative(force, 0), kernel.smooth_derivative(force, 1)
    target = -(shaken + command_derivatives[2] + force_seen - stated_lag * force_rate)
    constant = np.ones(target.size)
    values, covariance, residual = fit_equation(
        np.stack([command_derivatives[1], command_derivatives[0], constant]), target, kernel
    )
    spring = fit_spring(measured_displacement, force, kernel)
    square, spread = values[1] + spring.stiffness, spring.stiffness_deviation**2
    square_variance = covariance[1, 1] + spread
    square = max(square, _LEAST_STIFFNESS * structure.circular_frequency**2)
    w0 = float(np.sqrt(square))
    share = spring.stiffness / square
    damping_target = target - 2.0 * structure.damping_ratio * w0 * command_derivatives[1]
    late, late_spread, _ = fit_equation(
        np.stack([-force_rate, command_derivatives[0], constant]), damping_target, kernel
    )
    share_variance = (spread * (1.0 - share) ** 2 + covariance[1, 1] * share**2) / square**2
    return Identification(
        frequency=_frequency(w0, square_variance, structure),
        damping_ratio=_damping_ratio(values[0], covariance[0, 0], w0, square_variance, structure),
        experimental_fraction=IdentifiedParameter(
            value=float(share),
            deviation=float(np.sqrt(share_variance)),
            stated=structure.experimental_fraction,
        ),
        feedback_lag=IdentifiedParameter(
            value=stated_lag + float(late[0]), deviation=float(np.sqrt(late_spread[0, 0])), stated=stated_lag
        ),
        misfit=_misfit(residual, shaken),
    )


def _identify_without_force(
    command_derivatives: list[Array],
    shaken: Array,
    kernel: Kernel,
    structure: Structure,
    stated_lag: float,
    measured_displacement: Array,
) -> Identification:
    # αω₀²x_m(t − τ) = ω₀²(α x_m − ατ x_m'), and (1 − α)ω₀²x_c
    share = structure.experimental_fraction
    late = kernel.smooth_derivative(measured_displacement, 0) - stated_lag * kernel.smooth_derivative(
        measured_displacement, 1
    )
    sprung = share * late + (1.0 - share) * command_derivatives[0]
    columns = np.stack([command_derivatives[1], sprung, np.ones(sprung.size)])
    values, covariance, residual = fit_equation(columns, -(shaken + command_derivatives[2]), kernel)
    w0 = float(np.sqrt(max(values[1], _LEAST_STIFFNESS * structure.circular_frequency**2)))
    return Identification(
        frequency=_frequency(w0, covariance[1, 1], structure),
        damping_ratio=_damping_ratio(values[0], covariance[0, 0], w0, covariance[1, 1], structure),
        experimental_fraction=None,
        feedback_lag=None,
        misfit=_misfit(residual, shaken),
    )


def _frequency(w0: float, square_variance: float, structure: Structure) -> IdentifiedParameter:
    frequency = w0 / (2.0 * np.pi)
    return IdentifiedParameter(
        value=frequency, deviation=frequency * _relative(square_variance, w0), stated=structure.frequency
    )


def _damping_ratio(
    damping: float, variance: float, w0: float, square_variance: float, structure: Structure
) -> IdentifiedParameter:
    """Damping ratio from c = 2ξω₀ and its variance."""
    ratio = damping / (2.0 * w0)
    deviation = np.hypot(np.sqrt(variance) / (2.0 * w0), ratio * _relative(square_variance, w0))
    return IdentifiedParameter(value=float(ratio), deviation=float(deviation), stated=structure.damping_ratio)


def _relative(square_variance: float, w0: float) -> float:
    """Relative standard error of ω₀ from the variance of ω₀²."""
    return float(0.5 * np.sqrt(max(square_variance, 0.0)) / w0**2)


def _misfit(residual: Array, shaken: Array) -> float:
    """RMS of the residual over that of the ground acceleration, each weighted by the latter's power.

    After a short pulse only the sensors' noise is left, of which the ground acceleration explains nothing.
    """
    power = shaken**2
    total = float(power @ power)
    return float(np.sqrt(power @ residual**2 / total)) if total > 0.0 else 0.0


def _check(
    command: Array,
    measured_displacement: Array,
    ground: Array,
    force: Array | None,
    step: float,
    structure: Structure,
) -> None:
    sizes = {values.size for values in (command, measured_displacement, ground, force) if values is not None}
    if len(sizes) > 1:
        raise InputError(
            "Recorded histories must have the same length",
            value=", ".join(map(str, sorted(sizes))),
            remedy="Give all channels over the whole test",
        )
    if command.size * step * structure.frequency < _FEWEST_PERIODS:
        raise InputError(
            f"Parameters need at least {_FEWEST_PERIODS:.0f} periods of the structure",
            value=significant(command.size * step * structure.frequency, 2),
            remedy="Give the whole test",
        )
