"""Stability of a hybrid test whose numerical substructure is integrated in steps: its discrete poles.

The scheme of integration, the actuator's gain and delay and the linear specimen make one linear map from
step to step, over the motion now and the commands that are still on their way. The test is stable where no
eigenvalue z of the map lies outside the unit circle; ln(z)/h is the pole in continuous time. The locus of
the eigenvalues over the delay shows how much of the critical delay the integration costs.
"""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.errors import InputError
from reliab.structures.critical_delay import critical_delay
from reliab.structures.frames.response import exact_step
from reliab.structures.partition import Partition

_LONGEST_MEMORY = 400  # steps of delay that the map holds


class Scheme(StrEnum):
    """How the numerical substructure is integrated."""

    CENTRAL_DIFFERENCE = "central_difference"
    """Explicit Newmark, γ = ½ (Nakashima and others 1992)."""
    CHEN_RICLES = "chen_ricles"
    """Explicit in displacement and velocity, unconditionally stable (Chen and Ricles 2008)."""
    HELD_FORCE = "held_force"
    """Exact for a force that is held over the step and arrives a step late, as in the digital laboratory."""


def amplification_matrix(
    partition: Partition, step: float, gain: float, delay: float, scheme: Scheme
) -> Array:
    """Map of one step of the test without ground motion.

    `step` [s].
    Returns square matrix over displacements, velocities and accelerations of the numerical substructure, and
    over the interface's motion at the last steps.
    """
    steps = delay / step
    if not 0.0 <= steps <= _LONGEST_MEMORY:
        raise InputError(
            f"The discrete map holds delays from 0 to {_LONGEST_MEMORY} steps",
            value=f"{steps:g} steps",
            remedy="Choose a longer step or a shorter delay",
        )
    memory, n = int(steps) + 3, partition.frame.size
    advance = _Advance.of(partition, step, gain, steps, scheme)
    size = 3 * n + 3 * memory
    states = np.eye(size)
    # The map is linear: its columns are the images of the unit vectors.
    motion, past = states[: 3 * n].reshape(3, n, size), states[3 * n :].reshape(memory, 3, size)
    after, newest = advance(motion, past)
    moved = np.concatenate([newest[np.newaxis], past[:-1]])
    return np.concatenate([after.reshape(3 * n, size), moved.reshape(3 * memory, size)])


@dataclass(frozen=True, kw_only=True, eq=False)
class _Advance:
    """One step of a scheme, for many states at once."""

    partition: Partition
    step: float
    gain: float
    whole: int
    rest: float
    scheme: Scheme
    factor: Array
    transition: Array
    held: Array

    @classmethod
    def of(cls, partition: Partition, step: float, gain: float, steps: float, scheme: Scheme) -> "_Advance":
        frame, n = partition.frame, partition.frame.size
        whole = 4.0 * frame.mass + 2.0 * step * frame.damping + step**2 * frame.stiffness
        dynamics = np.zeros((2 * n, 2 * n))
        dynamics[:n, n:] = np.eye(n)
        dynamics[n:, :n] = -np.linalg.solve(partition.numerical_mass, partition.numerical_stiffness)
        dynamics[n:, n:] = -np.linalg.solve(partition.numerical_mass, partition.numerical_damping)
        loads = np.concatenate([np.zeros(n), -np.linalg.solve(partition.numerical_mass, partition.interface)])
        transition, early, late = exact_step(dynamics, loads[:, np.newaxis], step)
        return cls(
            partition=partition,
            step=step,
            gain=gain,
            whole=int(steps),
            rest=steps - int(steps),
            scheme=scheme,
            factor=np.asarray(np.linalg.solve(whole, 4.0 * frame.mass), dtype=np.float64),
            transition=transition,
            held=(early + late)[:, 0],
        )

    def __call__(self, motion: Array, past: Array) -> tuple[Array, Array]:
        """Motion after a step, shape (3, n, states), and that of the interface, shape (3, states)."""
        x, v, a = motion
        h, part, gamma = self.step, self.partition, self.partition.interface
        if self.scheme is Scheme.HELD_FORCE:
            # `past[0]` is the interface now: the force of the step before acts on.
            force = self._force(past[1:])
            after = self.transition @ np.concatenate([x, v]) + np.outer(self.held, force)
            x, v = after[: x.shape[0]], after[x.shape[0] :]
            load = part.numerical_damping @ v + part.numerical_stiffness @ x + np.outer(gamma, force)
            a = -np.linalg.solve(part.numerical_mass, load)
            return np.stack([x, v, a]), np.stack([gamma @ x, gamma @ v, gamma @ a])
        if self.scheme is Scheme.CHEN_RICLES:
            moved = self.factor @ a
            x, v = x + h * v + h**2 * moved, v + h * moved
            ahead = np.stack([gamma @ x, gamma @ v, past[0, 2]])
            force = self._force(np.concatenate([ahead[np.newaxis], past]))
            load = part.numerical_damping @ v + part.numerical_stiffness @ x + np.outer(gamma, force)
            a = -np.linalg.solve(part.numerical_mass, load)
        else:
            x, half = x + h * v + 0.5 * h**2 * a, v + 0.5 * h * a
            ahead = np.stack([gamma @ x, gamma @ (v + h * a), past[0, 2]])
            force = self._force(np.concatenate([ahead[np.newaxis], past]))
            load = part.numerical_damping @ half + part.numerical_stiffness @ x + np.outer(gamma, force)
            a = -np.linalg.solve(part.numerical_mass + 0.5 * h * part.numerical_damping, load)
            v = half + 0.5 * h * a
        return np.stack([x, v, a]), np.stack([gamma @ x, gamma @ v, gamma @ a])

    def _force(self, known: Array) -> Array:
        """Force of the specimen from the interface's motion, latest first, shape (steps, 3, states)."""
        late = (1.0 - self.rest) * known[self.whole] + self.rest * known[self.whole + 1]
        specimen = self.partition.specimen
        linear = specimen.stiffness * late[0] + specimen.damping * late[1] + specimen.mass * late[2]
        return np.asarray(self.gain * linear)


def discrete_poles(
    partition: Partition,
    step: float,
    *,
    gain: float = 1.0,
    delay: float = 0.0,
    scheme: Scheme = Scheme.CHEN_RICLES,
) -> NDArray[np.complex128]:
    """Poles ln(z)/h of the test as it is integrated [1/s], the least damped first.

    `step` [s].
    Returns poles with an imaginary part that is not negative; the test is stable where all real parts are
    negative.

    >>> from reliab.structures.structure import Structure
    >>> partition = Partition.of(Structure(frequency=1.0, damping_ratio=0.02))
    >>> poles = discrete_poles(partition, 1 / 1024, delay=0.007)  # beyond the critical 6.4 ms
    >>> bool(poles[0].real > 0.0)
    True
    """
    eigenvalues = np.linalg.eigvals(amplification_matrix(partition, step, gain, delay, scheme))
    kept = eigenvalues[(eigenvalues.imag >= 0.0) & (np.abs(eigenvalues) > 1e-12)]  # noqa: PLR2004 - empty memory
    poles = np.log(kept.astype(np.complex128)) / step
    return np.asarray(poles[np.argsort(-poles.real)])


def root_locus(
    partition: Partition,
    step: float,
    delays: Array,
    *,
    gain: float = 1.0,
    scheme: Scheme = Scheme.CHEN_RICLES,
) -> NDArray[np.complex128]:
    """Least damped discrete poles [1/s] over the delay, shape (delays, modes)."""
    count = partition.frame.size
    rows = [
        discrete_poles(partition, step, gain=gain, delay=float(delay), scheme=scheme)[:count]
        for delay in delays
    ]
    return np.stack(rows)


def discrete_critical_delay(
    partition: Partition, step: float, *, gain: float = 1.0, scheme: Scheme = Scheme.CHEN_RICLES
) -> float:
    """Delay [s] at which the test, integrated in steps, loses stability.

    `step` [s]; `gain` [-].
    Returns the critical delay; zero where the integration alone makes the test unstable, infinite where the
    test is still stable at twice the exact critical delay or, without such a delay, at 400 steps.
    """

    def growth(delay: float) -> float:
        return float(discrete_poles(partition, step, gain=gain, delay=delay, scheme=scheme)[0].real)

    if growth(0.0) >= 0.0:
        return 0.0
    exact, _ = critical_delay(partition, gain)
    furthest = min(2.0 * exact + 4.0 * step, _LONGEST_MEMORY * step)
    if growth(furthest) < 0.0:
        return math.inf
    return float(scipy.optimize.brentq(growth, 0.0, furthest, xtol=1e-3 * step))
