"""One structure with several actuators under one ground motion, ready to be solved for any actuators.

With R = Γᵀ(M s² + C s + K)⁻¹Γ of the undivided structure, the specimen's impedance Z and measured over
commanded displacement I + E at the interface, commands are y_c = (I + R Z E)⁻¹ y with the exact response y,
and the test strays by y_c + E y_c − y. Actuators that err alike, or one that errs alone, have E = e B with
e = k_p e^(−sτ) − 1. Then (I + eP)⁻¹ = Σ eᵏMₖ / Σ eᵏcₖ with P = R Z B, where Mₖ = cₖI − P Mₖ₋₁ and
cₖ = tr(P Mₖ₋₁)/k (Faddeev and LeVerrier), so that the structure is solved once for all gains and delays.

The denominator's winding number on the line of the transform counts the poles to its right: a test with one
diverges, and counts as infinitely wrong.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.arrays import Array, Spectrum
from reliab.compiled import compiled
from reliab.errors import InputError
from reliab.simulation.deviation import Deviation, peak_of_history
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_loop import longest_step
from reliab.simulation.linear_loop import TransformLine
from reliab.simulation.transfer_systems import ActuatorMatrix
from reliab.structures import Partition, Structure, frequencies_of_loop, longest_lead

_MOVES = 1e-4  # of the largest strain energy of the specimen: a displacement with less is not judged
_LEAST_SHARE, _LEAST_RATIO, _LARGEST_RATIO = 1e-3, 1e-4, 0.5


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledCells:
    """Gains k_p [-] and delays τ [s], negative for a lead, of the actuators that err, shape (cells,) each."""

    gain: Array
    delay: Array

    def __post_init__(self) -> None:
        if not (np.isfinite(self.gain) & np.isfinite(self.delay) & (self.gain > 0.0)).all():
            raise InputError(
                "Actuator gains must be positive and finite, delays finite",
                remedy="Give gains as measured over command amplitude and delays in seconds",
            )


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledLoop:
    """A structure with several actuators under one ground motion.

    The error is that of the interface displacement whose error is largest, over its own peak. Displacements
    that hardly strain the specimen under this motion are not judged.

    >>> w0 = 2.0 * np.pi
    >>> partition = Partition(mass=np.eye(2), damping=0.04 * w0 * np.eye(2),
    ...     stiffness=w0**2 * np.eye(2), interface=np.eye(2), specimen_stiffness=w0**2 * np.eye(2))
    >>> record = np.sin(2 * np.pi * np.arange(0, 20, 0.01))
    >>> loop = CoupledLoop(excitation=Excitation(acceleration=record, time_step=0.01), partition=partition,
    ...                    kinematics=np.eye(2))
    >>> strayed = loop.deviation(loop.cells(gain=1.0, delay=[0.001, 0.1]))
    >>> strayed.peak.round(2)
    array([0.14,  inf])
    """

    excitation: Excitation  # Record and window
    partition: Partition
    kinematics: Array  # T, displacements of the actuators per interface displacement, shape (p, p)
    # Place of the one that errs; None where all err alike; of two places the first moves with the command of
    # the second as well, by the gain less one
    actuator: int | tuple[int, int] | None = None

    @cached_property
    def governing_mode(self) -> Structure:
        """Frequency, damping ratio and share of the specimen of the mode that suffers most from an error."""
        whole = self.partition.with_masses
        squares, shapes = scipy.linalg.eigh(whole.stiffness, whole.mass)
        omega = np.sqrt(np.maximum(squares, 0.0))
        ratios = np.einsum("di,de,ei->i", shapes, whole.damping, shapes) / (2.0 * omega)
        moved = whole.interface.T @ shapes
        forces = np.array([whole.impedance(np.array([1j * w]))[0] for w in omega])
        share = np.abs(np.einsum("pi,ipq,qr,ri->i", moved, forces, self._erring, moved)) / squares
        driven = np.abs(shapes.T @ whole.mass @ whole.influence) * np.abs(moved).max(axis=0)
        place = int(np.argmax(share / np.maximum(ratios, _LEAST_RATIO) * driven / squares))
        return Structure(
            frequency=float(omega[place]) / (2.0 * np.pi),
            damping_ratio=float(ratios[place]),
            experimental_fraction=float(np.clip(share[place], 1e-6, 1.0)),
        )

    @property
    def structure(self) -> Structure:
        """One-mode structure that sets the scale of gains and delays: ξ over the specimen's share."""
        mode = self.governing_mode
        scale = mode.damping_ratio / max(mode.experimental_fraction, _LEAST_SHARE)
        return Structure(
            frequency=mode.frequency, damping_ratio=float(np.clip(scale, _LEAST_RATIO, _LARGEST_RATIO))
        )

    def cells(self, *, gain: object, delay: object) -> CoupledCells:
        """Actuators of given gains [-] and delays [s], which are broadcast and flattened."""
        gains, delays = np.broadcast_arrays(np.asarray(gain, dtype=float), np.asarray(delay, dtype=float))
        return CoupledCells(gain=gains.ravel(), delay=delays.ravel())

    def deviation(self, cells: CoupledCells) -> Deviation:
        """Deviation from the exact response, over its peak, of the displacement that strays furthest.

        Infinite where the test diverges.
        """
        sizes = np.empty((2, cells.gain.size))
        shift, latest = np.ones_like(self._line.s), 0.0
        for cell in np.argsort(cells.delay, kind="stable").tolist():
            if cells.delay[cell] != latest:
                latest = float(cells.delay[cell])
                shift = np.exp(-self._line.s * latest)
            sizes[:, cell] = self._sizes(cells.gain[cell] * shift - 1.0)
        return Deviation(mean_square=sizes[0], peak=sizes[1], ideal_peak=1.0)

    def at_rest(self) -> Deviation:
        """Deviation where the actuators that err do not move."""
        mean_square, peak = self._sizes(-np.ones_like(self._line.s))
        return Deviation(mean_square=np.array([mean_square]), peak=np.array([peak]), ideal_peak=1.0)

    def response(self, actuators: ActuatorMatrix) -> tuple[Array, Array, float]:
        """Commands and measured displacements of the interface [m], shape (p, n), and their step [s]."""
        error = actuators.at_interface(self._line.s) - np.eye(self.partition.degrees)
        force = self.partition.impedance(self._line.s) @ error
        loop = np.eye(self.partition.degrees) + self._receptance @ force
        command = np.linalg.solve(loop, self._exact[..., np.newaxis])
        measured = command + error @ command
        histories = [self._line.response(np.asarray(history[..., 0].T)) for history in (command, measured)]
        return histories[0], histories[1], self._line.step

    @cached_property
    def ideal(self) -> Array:
        """Exact response of the interface [m] at the steps, shape (p, n)."""
        return self._line.response(self._exact.T)

    @cached_property
    def judged(self) -> NDArray[np.bool_]:
        """Which interface displacements are judged, shape (p,)."""
        energy = np.diag(self.partition.specimen_stiffness) * self._peaks**2
        return np.asarray((energy >= _MOVES * energy.max()) & (self._peaks > 0.0))

    @cached_property
    def _peaks(self) -> Array:
        return np.array([peak_of_history(row) for row in self.ideal])

    @cached_property
    def _erring(self) -> Array:
        """B: what the actuators that err add to the interface per command, shape (p, p)."""
        size = len(self.kinematics)
        errs = np.eye(size) if self.actuator is None else np.zeros((size, size))
        if self.actuator is not None:
            moves, follows = self.actuator if isinstance(self.actuator, tuple) else (self.actuator,) * 2
            errs[moves, follows] = 1.0
        return np.asarray(np.linalg.solve(self.kinematics, errs @ self.kinematics))

    @cached_property
    def _line(self) -> TransformLine:
        mode = self.governing_mode
        fastest = 2.0 * np.pi * float(self.partition.natural_frequencies[-1])
        longest = longest_step(mode.circular_frequency, fastest)
        return TransformLine.for_excitation(self.excitation, longest, float(longest_lead(mode)))

    @cached_property
    def _solved(self) -> tuple[Spectrum, Spectrum]:
        return _moved(self.partition.with_masses, self._line.s)

    @property
    def _exact(self) -> Spectrum:
        """Interface displacements per −a_g [s²], shape (frequencies, p)."""
        return self._solved[0]

    @property
    def _receptance(self) -> Spectrum:
        """R [m/N], shape (frequencies, p, p)."""
        return self._solved[1]

    @cached_property
    def _series(self) -> tuple[Spectrum, Spectrum]:
        """Mₖ y and cₖ for the powers of e, shapes (p, p, frequencies) and (p + 1, frequencies)."""
        size = self.partition.degrees
        loop = self._receptance @ self.partition.impedance(self._line.s) @ self._erring
        adjoint = np.broadcast_to(np.eye(size, dtype=complex), loop.shape)
        commands, coefficients = [], [np.ones(len(loop), dtype=complex)]
        for power in range(size):
            commands.append((adjoint @ self._exact[..., np.newaxis])[..., 0].T)
            product = loop @ adjoint
            coefficients.append(np.trace(product, axis1=1, axis2=2) / (power + 1))
            adjoint = coefficients[-1][:, np.newaxis, np.newaxis] * np.eye(size) - product
        return np.array(commands), np.array(coefficients)

    def _sizes(self, error: Spectrum) -> tuple[float, float]:
        """Largest mean square and peak of the stray, over squares and peaks of the exact response."""
        spectra, denominator = _strayed(error, *self._series, self._exact, self._erring)
        if _winds(denominator):
            return np.inf, np.inf
        strayed = self._line.response(spectra)[self.judged]
        peaks = self._peaks[self.judged]
        squares = np.trapezoid(strayed**2, dx=self._line.step, axis=1) / self.excitation.window_duration
        largest = np.array([peak_of_history(row) for row in strayed])
        return float((squares / peaks**2).max()), float((largest / peaks).max())


def stable_with_several(partition: Partition, actuators: ActuatorMatrix) -> bool:
    """Whether a test with several actuators is stable, by the winding number of det(I + R Z E)."""
    whole = partition.with_masses
    s = np.asarray(1j * frequencies_of_loop(whole), dtype=np.complex128)
    error = actuators.at_interface(s) - np.eye(whole.degrees)
    loop = np.eye(whole.degrees) + _moved(whole, s)[1] @ whole.impedance(s) @ error
    return not _winds(np.linalg.det(loop))


def _moved(whole: Partition, s: Spectrum) -> tuple[Spectrum, Spectrum]:
    """Interface displacements per −a_g [s²] and per interface force [m/N], shapes (n, p) and (n, p, p)."""
    at = s[:, np.newaxis, np.newaxis]
    dynamic = at**2 * whole.mass + at * whole.damping + whole.stiffness
    loads = np.column_stack([whole.mass @ whole.influence, whole.interface]).astype(complex)
    moved = whole.interface.T @ np.linalg.solve(dynamic, loads)
    return moved[..., 0], moved[..., 1:]


@compiled
def _winds(denominator: Spectrum) -> bool:
    """Whether a function on the upper half of the line winds round zero."""
    crossings = 1 if denominator[0].real < 0.0 else 0
    for k in range(1, denominator.size):
        before, now = denominator[k - 1], denominator[k]
        if (before.imag < 0.0) != (now.imag < 0.0):
            share = before.imag / (before.imag - now.imag)
            if before.real + share * (now.real - before.real) < 0.0:
                crossings += 2 if now.imag < 0.0 else -2
    return crossings != 0


@compiled
def _strayed(
    error: Spectrum, commands: Spectrum, coefficients: Spectrum, exact: Spectrum, erring: Array
) -> tuple[Spectrum, Spectrum]:
    """Spectra of the stray, shape (p, frequencies), and the denominator, shape (frequencies,)."""
    size, count = erring.shape[0], error.size
    strayed = np.empty((size, count), dtype=np.complex128)
    denominators = np.empty(count, dtype=np.complex128)
    command = np.empty(size, dtype=np.complex128)
    for k in range(count):
        denominator = coefficients[size, k]
        for i in range(size):
            command[i] = 0.0
        for power in range(size - 1, -1, -1):
            denominator = denominator * error[k] + coefficients[power, k]
            for i in range(size):
                command[i] = command[i] * error[k] + commands[power, i, k]
        denominators[k] = denominator
        inverse = 1.0 / denominator
        for i in range(size):
            added = 0.0 + 0.0j
            for j in range(size):
                added += erring[i, j] * command[j]
            strayed[i, k] = (command[i] + error[k] * added) * inverse - exact[k, i]
    return strayed, denominators
