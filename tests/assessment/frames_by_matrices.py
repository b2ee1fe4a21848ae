"""Tests of linear frames with one actuator, simulated by code that shares nothing with the product.

A frame M, C, K is tested through one interface γ, or several: its specimen k_e, c_e, m_e stands in the
laboratory, and all else is computed. Actuators are of second order. The loop is one linear system, which is
stepped exactly for a ground motion that is a straight line between samples; with a specimen that yields
(bilinear, kinematic hardening) it is stepped in sixteenths of a sample.
"""

from dataclasses import dataclass, replace

import numba
import numpy as np
import scipy


@dataclass(frozen=True, kw_only=True, eq=False)
class Matrices:
    """The whole frame, specimen included, and the specimen alone."""

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    interface: np.ndarray  # γ, shape (n,), or of several actuators, shape (n, p)
    influence: np.ndarray
    specimen: tuple[float, float, float]  # At each interface k_e [N/m], c_e [N·s/m], m_e [kg]

    def with_storeys(self, name: str, factors: np.ndarray) -> "Matrices":
        """Shear frame whose storeys are as stiff, or as damped, as these factors say.

        Springs between the floors are read off the matrix: what is below its diagonal, and what is left.
        """
        matrix = getattr(self, name)
        return replace(self, **{name: shear(storeys_of(matrix) * factors)})

    def with_specimen(self, factor: float) -> "Matrices":
        """Specimen stronger by a factor; the computer's part stays as it is."""
        larger = np.outer(self.interface, self.interface) * (factor - 1.0)
        k, c, m = self.specimen
        return replace(
            self,
            mass=self.mass + m * larger,
            damping=self.damping + c * larger,
            stiffness=self.stiffness + k * larger,
            specimen=(k * factor, c * factor, m * factor),
        )

    def with_modes(self, frequencies: np.ndarray, ratios: np.ndarray) -> "Matrices":
        """Frame whose modes have other frequencies and damping ratios by factors, and the same shapes."""
        squares, shapes = scipy.linalg.eigh(self.stiffness, self.mass)
        back = self.mass @ shapes
        omega = np.sqrt(squares)
        xi = np.diag(shapes.T @ self.damping @ shapes) / (2.0 * omega)
        return replace(
            self,
            damping=back @ np.diag(2.0 * xi * omega * ratios * frequencies) @ back.T,
            stiffness=back @ np.diag(squares * frequencies**2) @ back.T,
        )


def storeys_of(matrix: np.ndarray) -> np.ndarray:
    """Springs or dashpots of the storeys of a shear frame, from the ground up."""
    upper = -np.diag(matrix, 1)
    return np.diag(matrix) - np.append(upper, 0.0)


def shear(storeys: np.ndarray) -> np.ndarray:
    """Matrix of a shear frame with these springs or dashpots."""
    return np.diag(storeys + np.append(storeys[1:], 0.0)) - np.diag(storeys[1:], 1) - np.diag(storeys[1:], -1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Outcome:
    """What was recorded, and what an actuator without error would have made of it."""

    command: np.ndarray  # x_c [m], shape (n,); of several actuators (p, n)
    measured: np.ndarray  # x_m [m], as x_c
    floors: np.ndarray  # Displacements that the computer had in the test [m], shape (floors, n)
    ideal: np.ndarray  # Those without an actuator's error [m], shape (floors, n)
    interface: np.ndarray
    force: np.ndarray | None = None  # Of a specimen that yields [N], shape (n,)

    @property
    def rms(self) -> float:
        """RMS^R of the measured interface displacement."""
        return self.error_of(self.measured, self.interface @ self.ideal)

    @staticmethod
    def error_of(history: np.ndarray, ideal: np.ndarray) -> float:
        """RMS^R of a response."""
        return float(np.sqrt(np.mean((history - ideal) ** 2)) / np.abs(ideal).max())


def run(
    frame: Matrices,
    gain: float | np.ndarray,
    corner: float | np.ndarray,
    ground: np.ndarray,
    step: float,
    damping: float = 0.7,
) -> Outcome | None:
    """Run a test with actuators of second order [rad/s]; None where the loop is unstable."""
    n, gamma, (k, c, m) = (
        frame.influence.size,
        frame.interface.reshape(frame.influence.size, -1),
        frame.specimen,
    )
    p, grid = gamma.shape[1], gamma @ gamma.T
    gain, corner = np.broadcast_to(gain, p), np.broadcast_to(corner, p)
    mass, viscous, stiffness = frame.mass - m * grid, frame.damping - c * grid, frame.stiffness - k * grid
    # state: x, x', y, y'; y'' = corner² (gain γᵀx − y) − 2 damping corner y'
    driven = np.hstack(
        [
            (gain * corner**2)[:, np.newaxis] * gamma.T,
            np.zeros((p, n)),
            -np.diag(corner**2),
            -2.0 * damping * np.diag(corner),
        ]
    )
    force = m * driven + np.hstack([np.zeros((p, 2 * n)), k * np.eye(p), c * np.eye(p)])
    solution = np.linalg.solve(mass, np.column_stack([stiffness, viscous, gamma @ force]))
    size = 2 * (n + p)
    a = np.zeros((size, size))
    a[:n, n : 2 * n] = np.eye(n)
    a[n : 2 * n] = -solution[:, 2 * n :]
    a[n : 2 * n, : 2 * n] -= solution[:, : 2 * n]
    a[2 * n : 2 * n + p, 2 * n + p :] = np.eye(p)
    a[2 * n + p :] = driven
    b = np.zeros((size, 1))
    b[n : 2 * n, 0] = -np.linalg.solve(mass, frame.mass @ frame.influence)
    if np.linalg.eigvals(a).real.max() > 0.0:
        return None
    full_test = np.zeros((2 * n, 2 * n))
    full_test[:n, n:] = np.eye(n)
    full_test[n:] = -np.linalg.solve(frame.mass, np.column_stack([frame.stiffness, frame.damping]))
    states = _simulate_states(a, b, ground, step)
    ideal = _simulate_states(
        full_test, np.append(np.zeros(n), -frame.influence)[:, np.newaxis], ground, step
    )[:n]
    return Outcome(
        command=frame.interface.T @ states[:n],
        measured=states[2 * n : 2 * n + p].reshape(*frame.interface.shape[1:], -1),
        floors=states[:n],
        ideal=ideal,
        interface=frame.interface,
    )


def run_yielding(
    frame: Matrices,
    gain: float,
    corner: float,
    ground: np.ndarray,
    step: float,
    ductility: float,
    hardening: float = 0.05,
) -> Outcome:
    """Run a test whose specimen yields, which has neither mass nor dashpot of its own.

    `ductility`: largest displacement of the linear specimen over that at which it yields.
    """
    k, gamma = frame.specimen[0], frame.interface
    inverse = np.linalg.inv(frame.mass)
    loads = inverse @ (frame.stiffness - k * np.outer(gamma, gamma)), inverse @ frame.damping
    shares = inverse @ gamma, frame.influence

    def stepped(place: float, actuator: tuple[float, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return _yielding(*loads, *shares, gamma, k, hardening, place, *actuator, ground, step)

    largest = float(np.abs(stepped(np.inf, (0.0, 0.0))[1]).max())
    floors, measured_displacement, force = stepped(largest / ductility, (gain, corner))
    ideal = stepped(largest / ductility, (0.0, 0.0))[0]
    return Outcome(
        command=gamma @ floors,
        measured=measured_displacement,
        floors=floors,
        ideal=ideal,
        interface=gamma,
        force=force,
    )


@numba.njit(cache=True)
def _yielding(
    stiffness: np.ndarray,
    damping: np.ndarray,
    by_force: np.ndarray,
    influence: np.ndarray,
    gamma: np.ndarray,
    k: float,
    hardening: float,
    yields: float,
    gain: float,
    corner: float,
    ground: np.ndarray,
    step: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Floors, displacement and force of the specimen; a corner of zero is a perfect actuator."""
    finer, size = 16, ground.size
    short, n = step / finer, influence.size
    x, v, y, w, plastic = np.zeros(n), np.zeros(n), 0.0, 0.0, 0.0
    floors, measured_displacement, force = np.zeros((n, size)), np.zeros(size), np.zeros(size)
    for i in range(1, size):
        for j in range(finer):
            shaken = ground[i - 1] + (ground[i] - ground[i - 1]) * j / finer
            if corner > 0.0:
                w += short * (corner**2 * (gain * gamma @ x - y) - 1.4 * corner * w)
                y += short * w
            else:
                y = gamma @ x
            elastic = y - plastic
            if abs(elastic) > yields:
                plastic += elastic - yields * np.sign(elastic)
            felt_displacement = k * (hardening * y + (1.0 - hardening) * (y - plastic))
            v -= short * (stiffness @ x + damping @ v + by_force * felt_displacement + influence * shaken)
            x += short * v
        floors[:, i], measured_displacement[i], force[i] = x, y, felt_displacement
    return floors, measured_displacement, force


def _simulate_states(a: np.ndarray, b: np.ndarray, values: np.ndarray, step: float) -> np.ndarray:
    """States under an input that is a straight line between samples, from rest, shape (states, n)."""
    size = a.shape[0]
    system = (a, b, np.eye(size), np.zeros((size, 1)))
    transition, early, output, single_run, _ = scipy.signal.cont2discrete(system, step, method="foh")
    poles, shapes = np.linalg.eig(transition)
    inputs = np.linalg.solve(shapes, early[:, 0])
    first = np.append(0.0, values[:-1])
    modes = [
        scipy.signal.lfilter([gain], [1.0, -pole], first) for gain, pole in zip(inputs, poles, strict=True)
    ]
    return np.asarray((output @ shapes @ np.array(modes)).real + single_run * values)


TWO_STOREYS = Matrices(
    mass=np.diag([2000.0, 1500.0]),
    damping=shear(np.array([2400.0, 1800.0])),
    stiffness=shear(np.array([4e5, 3e5])),
    interface=np.array([1.0, 0.0]),
    influence=np.ones(2),
    specimen=(2e5, 0.0, 0.0),
)
