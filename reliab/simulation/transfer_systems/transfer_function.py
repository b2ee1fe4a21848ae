"""Transfer systems: linear models of actuators with their specimen, and identified transfer functions."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import scipy
from numpy.typing import ArrayLike

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.core.stated_value import require_physical
from reliab.structures.frame import Specimen


@dataclass(frozen=True, kw_only=True)
class Plant:
    """A linear model w' = A w + b u − e f, of which the piston's motion and the force are rows.

    u is the command that arrives, f the force [N] of the specimen's nonlinear effects.
    """

    dynamics: Array  # A [1/s], shape (states, states)
    command: Array  # b, shape (states,)
    nonlinear: Array  # e, shape (states,); zero where the specimen does not act back on the piston
    # displacement, velocity: Rows of the piston's displacement [m] and velocity [m/s], shape (states,)
    displacement: Array
    velocity: Array
    force: Array  # Row of the specimen's force [N], nonlinear effects left out unless `contains_nonlinear`
    # displacement_of_command, force_of_command: Direct part of the command in the displacement [-] and in
    # that force [N/m]
    displacement_of_command: float = 0.0
    force_of_command: float = 0.0
    contains_nonlinear: bool = False  # Whether the force row holds the force of nonlinear effects too
    delay: float = 0.0  # Delay [s] of the command before it arrives
    # Part of A that acts through the velocity row, A = A₀ + differenced ⊗ velocity; an emulation of a block
    # diagram may take that velocity by differences. Shape (states,)
    differentiated: Array


class TransferSystem(ABC):
    """An actuator with its inner control: what turns a sent command into the motion of the piston."""

    @abstractmethod
    def plant(self, specimen: Specimen) -> Plant:
        """Model that drives a specimen."""

    @abstractmethod
    def transfer(self, s: Spectrum, specimen: Specimen) -> Spectrum:
        """Measured over sent displacement [-] at s [rad/s] with a linear specimen."""


_AXIS_TOLERANCE = 1e-9  # real part over modulus of a pole that lies on the imaginary axis
_REPEATED_TOLERANCE = 1e-6  # relative distance of poles that are one pole repeated
_MOST_SPREAD = 1e100  # of coefficients; a system of twenty poles at 10⁵ 1/s has as much


@dataclass(frozen=True, kw_only=True)
class TransferFunction(TransferSystem):
    """Measured over sent displacement as e^(−sτ)·(b_m sᵐ + … + b₀)/(s^n·a_n + … + a₀), whatever the specimen.

    >>> lag = TransferFunction(numerator=[1.0], denominator=[0.004, 1.0], delay=0.001)
    >>> complex(lag.transfer(np.array([10j]), Specimen(stiffness=1.0))[0].round(4))
    (0.998-0.0499j)
    """

    numerator: tuple[float, ...]  # numerator, denominator: Coefficients in descending powers of s
    denominator: tuple[float, ...]
    delay: float = 0.0  # τ [s], not negative

    def __post_init__(self) -> None:
        for name in ("numerator", "denominator"):
            values = np.trim_zeros(np.atleast_1d(np.asarray(getattr(self, name), dtype=np.float64)), "f")
            sound = values.ndim == 1 and values.size > 0 and np.isfinite(values).all()
            if not sound or np.abs(values).max() / _MOST_SPREAD > abs(values[0]):
                raise InputError(
                    f"The {name} of a transfer function needs finite coefficients, not all zero, the largest "
                    f"at most {_MOST_SPREAD:g} times the first",
                    value=getattr(self, name),
                    remedy="Give them in descending powers of s",
                )
            object.__setattr__(self, name, tuple(values.tolist()))
        if len(self.numerator) > len(self.denominator):
            raise InputError(
                "A transfer function must not have a numerator of higher order than its denominator",
                value=f"orders {len(self.numerator) - 1} and {len(self.denominator) - 1}",
                remedy="No actuator differentiates; add the poles that limit it",
            )
        if not (math.isfinite(self.delay) and self.delay >= 0.0):
            raise InputError(
                "The delay of a transfer function must not be negative",
                value=self.delay,
                remedy="Give seconds, 0.002 for 2 ms",
            )
        self._check_poles()

    def _check_poles(self) -> None:
        poles = self.poles
        if poles.size == 0:
            return
        scale = np.maximum(np.abs(poles), _AXIS_TOLERANCE * np.abs(poles).max())
        right = poles.real > _AXIS_TOLERANCE * scale
        if right.any():
            raise InputError(
                "A transfer system must be stable",
                value=f"a pole at {poles[right][0]:.6g} 1/s",
                remedy="Close the actuator's own displacement loop before it is identified",
            )
        axis_poles = poles[np.abs(poles.real) <= _REPEATED_TOLERANCE * scale]
        for place, pole in enumerate(axis_poles):
            if (np.abs(axis_poles[place + 1 :] - pole) <= _REPEATED_TOLERANCE * np.abs(poles).max()).any():
                raise InputError(
                    "A transfer system must not have repeated poles on the imaginary axis",
                    value=f"{pole:.6g} 1/s twice",
                    remedy="Its response would grow without bound; check the coefficients",
                )

    @classmethod
    def from_poles(
        cls, zeros: ArrayLike, poles: ArrayLike, gain: float, *, static: bool = False, delay: float = 0.0
    ) -> Self:
        """Return the transfer function gain·Π(s − z)/Π(s − p).

        `delay` [s].

        >>> TransferFunction.from_poles([], [-100.0], 1.0, static=True).numerator
        (100.0,)
        """
        numerator, denominator = (np.atleast_1d(np.poly(np.asarray(roots))) for roots in (zeros, poles))
        for name, values in (("zeros", numerator), ("poles", denominator)):
            if np.iscomplexobj(values):
                raise InputError(
                    f"Complex {name} must come in conjugate pairs",
                    value=list(np.asarray(values)),
                    remedy="Add the conjugate of each",
                )
        factor = gain * denominator[-1] / numerator[-1] if static else gain
        return cls(numerator=tuple(factor * numerator), denominator=tuple(denominator), delay=delay)

    @property
    def poles(self) -> Spectrum:
        """Poles [1/s], shape (order,)."""
        return np.asarray(np.roots(self.denominator), dtype=np.complex128)

    @property
    def zeros(self) -> Spectrum:
        """Zeros [1/s]."""
        return np.asarray(np.roots(self.numerator), dtype=np.complex128)

    def transfer(self, s: Spectrum, specimen: Specimen) -> Spectrum:
        """Measured over sent displacement [-] at s [rad/s]; the specimen does not matter."""
        del specimen
        rational = np.polyval(self.numerator, s) / np.polyval(self.denominator, s)
        return np.asarray(rational * np.exp(-s * self.delay))

    def plant(self, specimen: Specimen) -> Plant:
        """State-space model of the rational part, in a time that suits its poles."""
        relative = len(self.denominator) - len(self.numerator)
        excess_poles = 2 if specimen.mass > 0.0 else (1 if specimen.damping else 0)
        if relative < excess_poles:
            raise InputError(
                f"Before a specimen with {'mass' if excess_poles > 1 else 'damping'} a transfer system needs "
                f"at least {excess_poles} more poles than zeros, since a sampled command jumps and a piston "
                "cannot",
                value=f"{relative} more",
                remedy="Add the pole of the servo-valve, at some 100 Hz",
            )
        a, b, c, d = self._state_space()
        order = a.shape[0]
        rows = [c, c @ a, c @ a @ a]
        linear = (specimen.stiffness, specimen.damping, specimen.mass)
        command_feedthrough = (d, float(c @ b), float(c @ a @ b))
        return Plant(
            dynamics=a,
            command=b,
            nonlinear=np.zeros(order),
            displacement=c,
            velocity=rows[1],
            force=sum((k * row for k, row in zip(linear, rows, strict=True)), np.zeros(order)),
            displacement_of_command=d,
            force_of_command=sum(k * direct for k, direct in zip(linear, command_feedthrough, strict=True)),
            delay=self.delay,
            differentiated=np.zeros(order),
        )

    def _state_space(self) -> tuple[Array, Array, Array, float]:
        n = len(self.denominator) - 1
        if n == 0:
            return np.zeros((0, 0)), np.zeros(0), np.zeros(0), self.numerator[0] / self.denominator[0]
        moduli = np.abs(self.poles)
        scale = float(np.exp(np.mean(np.log(moduli[moduli > 0.0])))) if (moduli > 0.0).any() else 1.0
        powers = scale ** np.arange(n, -1, -1.0)
        numerator = np.asarray(self.numerator) * powers[-len(self.numerator) :]
        denominator = np.asarray(self.denominator) * powers
        a, b, c, d = scipy.signal.tf2ss(numerator / denominator[0], denominator / denominator[0])
        return scale * a, scale * b[:, 0], c[0], float(d[0, 0])


def gain_and_delay(gain: float = 1.0, delay: float = 0.0) -> TransferFunction:
    """Transfer function k_p e^(−sτ)."""
    if not (math.isfinite(gain) and gain > 0.0):
        raise InputError(
            "The actuator's gain must be positive and finite",
            value=gain,
            remedy="Give measured over commanded displacement, 1 for an exact actuator",
        )
    return TransferFunction(numerator=(gain,), denominator=(1.0,), delay=delay)


def coefficients_of(values: Sequence[float] | Array) -> tuple[float, ...]:
    """Coefficients as a tuple of plain numbers."""
    return tuple(np.atleast_1d(np.asarray(values, dtype=np.float64)).ravel().tolist())


_WORST_CONDITION = 1e10  # of the kinematics, after rows and columns are scaled
_PLACEHOLDER_SPECIMEN = Specimen(stiffness=1.0)  # transfer functions do not depend on it


@dataclass(frozen=True, kw_only=True, eq=False)
class ActuatorMatrix:
    """Actuators whose commands are a_c = T y_c of the interface's, and whose motion is a_m = H(s) a_c.

    A second actuator that is carried along by the first:

    >>> lag, none = TransferFunction(numerator=(1.0,), denominator=(0.01, 1.0)), None
    >>> coupled = TransferFunction(numerator=(0.1,), denominator=(0.01, 1.0))
    >>> actuators = ActuatorMatrix(kinematics=np.eye(2), transfer=((lag, none), (coupled, lag)))
    >>> abs(actuators.interface_transfer(np.array([0j]))[0]).round(2)
    array([[1. , 0. ],
           [0.1, 1. ]])
    """

    kinematics: Array  # T, displacements of the actuators per interface displacement, shape (p, p)
    # H, measured over commanded displacement of actuators, row by row; None where there is no coupling
    transfer: tuple[tuple[TransferFunction | None, ...], ...]

    def __post_init__(self) -> None:
        kinematics = invertible(self.kinematics)
        object.__setattr__(self, "kinematics", kinematics)
        if {len(row) for row in self.transfer} != {kinematics.shape[0]} or len(self.transfer) != len(
            kinematics
        ):
            raise InputError(
                "The matrix of transfer functions needs a row and a column for each actuator",
                value=f"rows of {[len(row) for row in self.transfer]} for {kinematics.shape[0]} actuators",
                remedy="Give 0 where actuators are not coupled",
            )

    def actuator_transfer(self, s: Spectrum) -> Spectrum:
        """H at s [rad/s], shape (…, p, p)."""
        s = np.asarray(s, dtype=np.complex128)
        zero = np.zeros_like(s)
        rows = [
            [zero if entry is None else entry.transfer(s, _PLACEHOLDER_SPECIMEN) for entry in row]
            for row in self.transfer
        ]
        return np.moveaxis(np.array(rows), (0, 1), (-2, -1))

    def interface_transfer(self, s: Spectrum) -> Spectrum:
        """Measured over commanded displacement of the interface, T⁻¹HT, at s [rad/s], shape (…, p, p)."""
        return np.asarray(np.linalg.solve(self.kinematics, self.actuator_transfer(s) @ self.kinematics))


def invertible(kinematics: Array) -> Array:
    """Return the matrix of kinematics, which must be square, finite and not singular."""
    matrix = np.array(kinematics, dtype=np.float64)
    if matrix.ndim != 2 or not np.isfinite(matrix).all():  # noqa: PLR2004
        raise InputError(
            "The kinematics need rows of finite numbers",
            value=f"shape {matrix.shape}",
            remedy="Give a row for each actuator",
        )
    if matrix.shape[0] > matrix.shape[1]:
        raise InputError(
            "There must not be more actuators than degrees of freedom of the specimen: they would work "
            "against each other",
            value=f"{matrix.shape[0]} actuators and {matrix.shape[1]} degrees of freedom",
            remedy="Name all driven degrees of freedom, or leave an actuator out",
        )
    if matrix.shape[0] < matrix.shape[1]:
        raise InputError(
            "Each degree of freedom of the specimen needs an actuator",
            value=f"{matrix.shape[0]} actuators and {matrix.shape[1]} degrees of freedom",
            remedy="Leave out the degrees of freedom that are free, and condense them",
        )
    largest = np.abs(matrix).max(axis=0)
    scaled_matrix = matrix / np.where(largest > 0.0, largest, 1.0)
    if not np.linalg.cond(scaled_matrix) < _WORST_CONDITION:
        raise InputError(
            "The kinematics must not be singular: the actuators must be able to move every degree of "
            "freedom by itself",
            value=f"rank {np.linalg.matrix_rank(scaled_matrix)} of {matrix.shape[0]}",
            remedy="Check the lever arms; one row holds the displacement of one actuator",
        )
    return matrix


@dataclass(frozen=True, kw_only=True)
class ServoHydraulic(TransferSystem):
    """Servo-valve, actuator and displacement loop of a hydraulic ram that pushes a specimen.

    The error g·u − x drives the valve a₁β₀/(s² + β₁s + β₂); the flow less a₂x' makes, through 1/(s + a₃), the
    force F, which moves the specimen 1/(m_e s² + c_e s + k_e). The defaults are those of the virtual
    hybrid-simulation benchmark.

    Silva, C. E., Gomez, D., Maghareh, A., Dyke, S. J. and Spencer, B. F. (2020). Benchmark control problem
    for real-time hybrid simulation. *Mech. Syst. Signal Process.* 135, 106381.

    >>> specimen = Specimen(stiffness=1.19e6, damping=114.2, mass=29.13)
    >>> gain = abs(ServoHydraulic().transfer(np.array([2j * np.pi * 3.6124]), specimen)[0])
    >>> round(float(gain), 3)
    0.915
    """

    input_gain: float = 1.0261  # g [-]
    valve_gain: float = 2.1283e13  # a₁β₀ [N/(m·s³)]
    piston_coupling: float = 4.2297e6  # a₂ [N/m]
    leakage: float = 3.3  # a₃ [1/s]
    valve_damping: float = 425.0  # valve_damping, valve_stiffness: β₁ [1/s] and β₂ [1/s²]
    valve_stiffness: float = 9.9976e4

    def __post_init__(self) -> None:
        for name in (
            *("input_gain", "valve_gain", "piston_coupling"),
            *("leakage", "valve_damping", "valve_stiffness"),
        ):
            label = f"{name.replace('_', ' ')} of a servo-hydraulic actuator"
            require_physical("number", getattr(self, name), label=label)

    def perturb(self, deviations: Array) -> Self:
        """Return the actuator with leakage, valve damping and stiffness off by deviations [SI], (3,)."""
        leakage, damping, stiffness = map(float, deviations)
        return replace(
            self,
            leakage=self.leakage + leakage,
            valve_damping=self.valve_damping + damping,
            valve_stiffness=self.valve_stiffness + stiffness,
        )

    def plant(self, specimen: Specimen) -> Plant:
        """States: valve flow, its rate, force, displacement, velocity; without a moving mass fewer."""
        if specimen.mass > 0.0:
            return self._massive_plant(specimen)
        return self._massless_plant(specimen)

    def _massive_plant(self, specimen: Specimen) -> Plant:
        dynamics = np.zeros((5, 5))
        dynamics[0, 1] = 1.0
        dynamics[1] = [-self.valve_stiffness, -self.valve_damping, 0.0, -self.valve_gain, 0.0]
        dynamics[2] = [1.0, 0.0, -self.leakage, 0.0, -self.piston_coupling]
        dynamics[3, 4] = 1.0
        dynamics[4, 2:] = [1.0, -specimen.stiffness, -specimen.damping]
        dynamics[4] /= specimen.mass
        rows = np.eye(5)
        return Plant(
            dynamics=dynamics,
            command=self.input_gain * self.valve_gain * rows[1],
            nonlinear=rows[4] / specimen.mass,
            displacement=rows[3],
            velocity=rows[4],
            force=rows[2],
            contains_nonlinear=True,
            differentiated=-self.piston_coupling * rows[2],
        )

    def _massless_plant(self, specimen: Specimen) -> Plant:
        """Force and displacement are one state, F = kx; a dashpot makes the velocity another."""
        k, c = specimen.stiffness, specimen.damping
        if k <= 0.0:
            raise InputError(
                "A specimen without moving mass needs a stiffness to hold the actuator",
                value=f"{k:g} N/m",
                remedy="Give the specimen its moving mass, with the clevis and the piston rod",
            )
        if c > 0.0:
            raise InputError(
                "A specimen with damping needs a moving mass before this actuator",
                value="0 kg",
                remedy="Give the mass of the clevis and the piston rod",
            )
        dynamics = np.zeros((3, 3))
        dynamics[0, 1] = 1.0
        dynamics[1] = [-self.valve_stiffness, -self.valve_damping, -self.valve_gain]
        dynamics[2] = np.array([1.0, 0.0, -self.leakage * k]) / (k + self.piston_coupling)
        rows = np.eye(3)
        return Plant(
            dynamics=dynamics,
            command=self.input_gain * self.valve_gain * rows[1],
            nonlinear=np.zeros(3),
            displacement=rows[2],
            velocity=dynamics[2],
            force=k * rows[2],
            differentiated=np.zeros(3),
        )

    def transfer(self, s: Spectrum, specimen: Specimen) -> Spectrum:
        """Measured over sent displacement [-] at s [rad/s]."""
        impedance = specimen.stiffness + s * (specimen.damping + s * specimen.mass)
        valve = s * s + self.valve_damping * s + self.valve_stiffness
        loop = valve * ((s + self.leakage) * impedance + self.piston_coupling * s) + self.valve_gain
        return np.asarray(self.input_gain * self.valve_gain / loop)
