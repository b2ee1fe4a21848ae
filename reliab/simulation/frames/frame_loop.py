"""One structure with any number of actuators under one ground motion, solved for any of them.

The engine "spectral" is exact. With one actuator each cell is solved with the pole pairs of the test (engine
"pole"), which is faster; where the part that they neglect matters for the record at hand, and the test is
stable, the exact engine takes over.

With R = Γᵀ(M s² + C s + K)⁻¹Γ of the undivided structure, the specimen's impedance Z and measured over
commanded displacement I + E at the interface, commands are y_c = (I + R Z E)⁻¹ y with the exact response y,
and measured displacements stray by (I − R Z)E y_c; a floor strays by −R_o Z E y_c with its receptance R_o.
Actuators that err alike, or one that errs alone, have E = e B with e = k_p e^(−sτ) − 1. Then
(I + eP)⁻¹ = Σ eᵏMₖ / Σ eᵏcₖ with P = R Z B, where Mₖ = cₖI − P Mₖ₋₁ and cₖ = tr(P Mₖ₋₁)/k (Faddeev and
LeVerrier), so that the structure is solved once for all gains and delays.

The denominator's winding number on the line of the transform counts the poles to its right: a test with one
diverges violently, and counts as infinitely wrong; one that grows slowly is followed.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum
from reliab.core.compiled import compiled
from reliab.core.errors import InputError
from reliab.simulation.engine import Engine
from reliab.simulation.excitation import Deviation, Excitation, peak_of_history
from reliab.simulation.frames.frame_file import governing_mode, scale_of_errors
from reliab.simulation.frames.reduced_loop import ReducedLoop
from reliab.simulation.linear_loop.spectral import TransformLine
from reliab.simulation.transfer_systems.transfer_function import ActuatorMatrix, TransferSystem
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure, longest_lead

_MOVES = 1e-4  # of the largest strain energy of the specimen: a displacement with less is not judged
_FREQUENCIES = 6000
_AROUND_A_MODE = 400
_LOWEST, _HIGHEST = 1e-3, 1e4  # of the lowest and the highest natural frequency
_WIDEST = 30.0  # bandwidths of a mode


@dataclass(frozen=True, kw_only=True, eq=False)
class RigResponse:
    """Histories of a test with known actuators, inside the window."""

    command: Array  # command, measured: interface displacements y_c and y_m [m], shape (p, n)
    measured: Array
    # response, ideal: what counts, and what the undivided structure does [m], shape (q, n)
    response: Array
    ideal: Array
    step: float  # Step [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class ExactLoop:
    """A structure with actuators under one ground motion.

    Its responses are the measured interface displacements, or one that is a sum of degrees of freedom.
    """

    excitation: Excitation  # Record and window
    partition: Partition  # With a mass at every degree of freedom
    erring: Array  # B: what the actuators that err add to the interface per command, shape (p, p)
    output: Array | None  # Weights of the degrees of freedom, shape (n,); None for the interface
    longest_step: float  # s
    lead: float  # Longest one [s]

    def deviation(self, gain: Array, delay: Array) -> Deviation:
        """Deviation with actuators of gains k_p [-] and delays τ [s], shape (cells,).

        Of several responses the one that strays furthest counts, over the peak of its exact one. Infinite
        where the test diverges violently.
        """
        sizes = np.empty((2, gain.size))
        shift, latest = np.ones_like(self._line.s), 0.0
        for cell in np.argsort(delay, kind="stable").tolist():
            if delay[cell] != latest:
                latest = float(delay[cell])
                shift = np.exp(-self._line.s * latest)
            sizes[:, cell] = self._sizes(gain[cell] * shift - 1.0)
        return self._as_deviation(sizes)

    def rest_deviation(self) -> Deviation:
        """Deviation where the actuators that err do not move, whose part may then be free to drift."""
        return self._as_deviation(np.array(self._sizes(-np.ones_like(self._line.s)))[:, np.newaxis])

    def response(self, actuators: TransferSystem | ActuatorMatrix) -> RigResponse:
        """Histories of a test with actuators that are known over frequency."""
        s, partition = self._line.s, self.partition
        error = error_of(actuators, partition, s)
        loop = np.eye(partition.degrees) + self._receptance @ partition.impedance(s) @ error
        command = np.linalg.solve(loop, self._interface[..., np.newaxis])
        sent, measured_displacement, difference = (
            self._line.response(np.asarray(spectra[..., 0].T, dtype=np.complex128))
            for spectra in (command, command + error @ command, self._strays @ error @ command)
        )
        return RigResponse(
            command=sent,
            measured=measured_displacement,
            response=measured_displacement if self.output is None else self.ideal + difference,
            ideal=self.ideal,
            step=self._line.step,
        )

    @cached_property
    def ideal(self) -> Array:
        """Exact responses [m] at the steps, shape (q, n)."""
        return self._line.response(self._exact.T)

    @cached_property
    def is_output(self) -> NDArray[np.bool_]:
        """Which responses are judged, shape (q,): those that strain the specimen under this motion."""
        if len(self._peaks) == 1:
            return np.ones(1, dtype=bool)
        energy = np.diag(self.partition.specimen_stiffness) * self._peaks**2
        return np.asarray((energy >= _MOVES * energy.max()) & (self._peaks > 0.0))

    @cached_property
    def _peaks(self) -> Array:
        return np.array([peak_of_history(row) for row in self.ideal])

    @cached_property
    def _line(self) -> TransformLine:
        return TransformLine.from_excitation(self.excitation, self.longest_step, self.lead)

    @cached_property
    def _system_transfer(self) -> tuple[Spectrum, Spectrum]:
        """Degrees of freedom per −a_g [s²] and per interface force [m/N], (n, size) and (n, size, p)."""
        return _displacement_transfer(self.partition, self._line.s)

    @property
    def _interface(self) -> Spectrum:
        """Exact interface displacements per −a_g [s²], shape (frequencies, p)."""
        return np.asarray(self._system_transfer[0] @ self.partition.interface)

    @cached_property
    def _exact(self) -> Spectrum:
        """Exact responses per −a_g [s²], shape (frequencies, q)."""
        if self.output is None:
            return self._interface
        return np.asarray(self._system_transfer[0] @ self.output[:, np.newaxis])

    @cached_property
    def _receptance(self) -> Spectrum:
        """R [m/N], shape (frequencies, p, p)."""
        return np.asarray(self.partition.interface.T @ self._system_transfer[1])

    @cached_property
    def _strays(self) -> Spectrum:
        """By what responses stray per error at the interface [-], shape (frequencies, q, p)."""
        impedance = self.partition.impedance(self._line.s)
        if self.output is None:
            return np.asarray(np.eye(self.partition.degrees) - self._receptance @ impedance)
        return np.asarray(-(self.output @ self._system_transfer[1])[:, np.newaxis] @ impedance)

    @cached_property
    def _series(self) -> tuple[Spectrum, Spectrum]:
        """(I − R Z)B Mₖ y and cₖ for the powers of e, shapes (p, q, frequencies) and (p + 1, frequencies)."""
        size, exact = self.partition.degrees, self._interface[..., np.newaxis]
        loop = self._receptance @ self.partition.impedance(self._line.s) @ self.erring
        strays = self._strays @ self.erring
        adjoint = np.broadcast_to(np.eye(size, dtype=complex), loop.shape)
        differences, coefficients = [], [np.ones(len(loop), dtype=complex)]
        for power in range(size):
            differences.append((strays @ (adjoint @ exact))[..., 0].T)
            product = loop @ adjoint
            coefficients.append(np.trace(product, axis1=1, axis2=2) / (power + 1))
            adjoint = coefficients[-1][:, np.newaxis, np.newaxis] * np.eye(size) - product
        return np.array(differences), np.array(coefficients)

    def _sizes(self, error: Spectrum) -> tuple[float, float]:
        """Largest mean square and peak of the stray, of several responses over those of the exact one."""
        spectra, denominator = _deviation_spectra(error, *self._series)
        if _winds(denominator):
            return np.inf, np.inf
        differences = self._line.response(spectra)[self.is_output]
        peaks = self._peaks[self.is_output] if len(self._peaks) > 1 else np.ones(1)
        squares = np.trapezoid(differences**2, dx=self._line.step, axis=1) / self.excitation.window_duration
        largest = np.array([peak_of_history(row) for row in differences])
        return float((squares / peaks**2).max()), float((largest / peaks).max())

    def _as_deviation(self, sizes: Array) -> Deviation:
        ideal = float(self._peaks[0]) if len(self._peaks) == 1 else 1.0
        return Deviation(mean_square=sizes[0], peak=sizes[1], ideal_peak=ideal)


def error_of(actuators: TransferSystem | ActuatorMatrix, partition: Partition, s: Spectrum) -> Spectrum:
    """E: measured over commanded displacement of the interface, less one, at s [rad/s], shape (n, p, p)."""
    if isinstance(actuators, ActuatorMatrix):
        return np.asarray(actuators.interface_transfer(s) - np.eye(partition.degrees))
    return np.asarray(actuators.transfer(s, partition.specimen) - 1.0)[:, np.newaxis, np.newaxis]


def stable_with(partition: Partition, actuators: TransferSystem | ActuatorMatrix) -> bool:
    """Whether a test with actuators that are known over frequency is stable.

    The structure alone is stable, so that the test is where det(I + R Z E) does not turn around zero while s
    runs up the imaginary axis (criterion of Nyquist).

    >>> from reliab.core.shipped import shipped
    >>> from reliab.simulation.frames.frame_file import read_frame
    >>> from reliab.simulation.transfer_systems.transfer_function import gain_and_delay
    >>> partition = read_frame(shipped("datasets", "frames/benchmark_case_1.toml")).partition
    >>> [stable_with(partition, gain_and_delay(delay=delay)) for delay in (0.0146, 0.0147)]
    [True, False]
    """
    regular = partition.nonsingular_form
    s = (2j * np.pi * _frequencies(regular)).astype(np.complex128)
    receptance = regular.interface.T @ _displacement_transfer(regular, s)[1]
    loop = np.eye(regular.degrees) + receptance @ regular.impedance(s) @ error_of(actuators, regular, s)
    phase = np.unwrap(np.angle(np.linalg.det(loop)))
    return bool(abs(phase[-1] - phase[0]) < np.pi)


def _frequencies(partition: Partition) -> Array:
    """Frequencies [Hz] up the axis, close to each other where a mode turns the phase."""
    modes, damping_ratios, _ = partition.modes
    span = np.geomspace(_LOWEST * modes[0], _HIGHEST * modes[-1], _FREQUENCIES)
    reach = np.linspace(-_WIDEST, _WIDEST, _AROUND_A_MODE)
    ratios = np.maximum(damping_ratios, 1e-6)
    near = modes[:, np.newaxis] * (1.0 + ratios[:, np.newaxis] * np.sinh(reach / 6.0) * 0.5)
    return np.unique(np.concatenate([span, near[near > 0.0].ravel()]))


def _displacement_transfer(regular: Partition, s: Spectrum) -> tuple[Spectrum, Spectrum]:
    """Displacements per −a_g [s²] and per interface force [m/N], shapes (n, size) and (n, size, p)."""
    s_matrix = s[:, np.newaxis, np.newaxis]
    dynamic = s_matrix**2 * regular.mass + s_matrix * regular.damping + regular.stiffness
    loads = np.column_stack([regular.mass @ regular.influence, regular.interface]).astype(complex)
    displacement = np.linalg.solve(dynamic, loads)
    return np.asarray(displacement[..., 0]), np.asarray(displacement[..., 1:])


@compiled
def _winds(denominator: Spectrum) -> bool:
    """Whether a function on the upper half of the line winds round zero."""
    crossings = 1 if denominator[0].real < 0.0 else 0
    for k in range(1, denominator.size):
        previous, now = denominator[k - 1], denominator[k]
        if (previous.imag < 0.0) != (now.imag < 0.0):
            share = previous.imag / (previous.imag - now.imag)
            if previous.real + share * (now.real - previous.real) < 0.0:
                crossings += 2 if now.imag < 0.0 else -2
    return crossings != 0


@compiled
def _deviation_spectra(
    error: Spectrum, series: Spectrum, coefficients: Spectrum
) -> tuple[Spectrum, Spectrum]:
    """Spectra of the stray, shape (q, frequencies), and the denominator, shape (frequencies,)."""
    powers, count, outputs = series.shape[0], error.size, series.shape[1]
    difference_spectra = np.empty((outputs, count), dtype=np.complex128)
    denominators = np.empty(count, dtype=np.complex128)
    for k in range(count):
        denominator = coefficients[powers, k]
        for power in range(powers - 1, -1, -1):
            denominator = denominator * error[k] + coefficients[power, k]
        denominators[k] = denominator
        factor = error[k] / denominator
        for i in range(outputs):
            value = series[powers - 1, i, k]
            for power in range(powers - 2, -1, -1):
                value = value * error[k] + series[power, i, k]
            difference_spectra[i, k] = value * factor
    return difference_spectra, denominators


REDUCTION_TOLERANCE = 3e-3
"""Largest relative error of RMS^R that the reduction to pole pairs may cause [-]."""

_PHASE_STEP = 0.09  # rad of the governing mode in a step: its sampled peak is then within 1e-3
_FASTEST_PHASE_STEP = 0.6  # rad of the highest mode, which contributes little to the response
_SHORTEST_STEP = 0.002
_LONGEST_STEP = 0.01
_STEP_OF_RIG = 1.0 / 512.0


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameCells:
    """Gains k_p [-], positive, and delays τ [s], negative for a lead, of actuators, shape (cells,) each."""

    gain: Array
    delay: Array

    def __post_init__(self) -> None:
        sound = np.isfinite(self.gain) & np.isfinite(self.delay) & (self.gain > 0.0)
        if not sound.all():
            raise InputError(
                "Actuator gains must be positive and finite, delays finite",
                value=f"{self.gain[~sound][0]:g} and {self.delay[~sound][0]:g} s",
                remedy="Give gains as measured over command amplitude and delays in seconds",
            )


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameLoop:
    """A partitioned frame under one ground motion.

    With several actuators the error is that of the interface displacement whose error is largest, over its
    own peak; displacements that hardly strain the specimen under this motion are not judged.

    >>> from reliab.core.shipped import shipped
    >>> from reliab.simulation.frames.frame_file import read_frame
    >>> frame = read_frame(shipped("datasets", "frames/benchmark_case_1.toml"))
    >>> record = np.sin(2 * np.pi * np.arange(0, 20, 0.01))
    >>> excitation = Excitation(acceleration=record, time_step=0.01)
    >>> loop = FrameLoop(excitation=excitation, partition=frame.partition)
    >>> found = loop.deviation(loop.cells(gain=1.0, delay=0.002))
    >>> (found.peak / found.ideal_peak).round(3)
    array([0.018])
    """

    excitation: Excitation  # Record and window
    partition: Partition  # The partitioned frame, with a linear specimen
    # T, displacements of the actuators per interface displacement, shape (p, p); the identity by default
    kinematics: Array | None = None
    # Place of the actuator that errs; None where all err alike; of two places the first moves with the
    # command of the second as well, by the gain less one
    actuator: int | tuple[int, int] | None = None
    # Weights of the degrees of freedom in the response whose error counts, as of a floor or a drift of the
    # numerical substructure; by default it is the measured interface displacement
    output: Array | None = None
    engine: Engine = Engine.AUTOMATIC  # How the test is solved; "automatic", "pole" or "spectral"

    def __post_init__(self) -> None:
        if self.partition.effects:
            raise InputError(
                "A boundary of a frame needs a linear specimen",
                value=", ".join(effect.name for effect in self.partition.effects),
                remedy="Run the digital laboratory for a nonlinear one",
            )
        engines = {Engine.AUTOMATIC, Engine.SPECTRAL} | ({Engine.POLE} if self._has_one_actuator else set())
        if self.engine not in engines:
            raise InputError(
                "A frame is solved by the engines automatic, spectral or, with one actuator, pole",
                value=self.engine,
                remedy="Choose one of these",
            )
        if self.output is not None and np.shape(self.output) != (self.partition.nonsingular_form.size,):
            raise InputError(
                f"An output needs {self.partition.nonsingular_form.size} weights", value=np.shape(self.output)
            )

    @property
    def _has_one_actuator(self) -> bool:
        return self.partition.degrees == 1

    @property
    def governing_mode(self) -> Structure:
        """The mode that governs the error."""
        return governing_mode(self.partition, self.output, self._erring)

    @cached_property
    def structure(self) -> Structure:
        """One-mode structure that sets the scale of gains and delays."""
        return scale_of_errors(self.partition, self.output, self._erring)

    @cached_property
    def _erring(self) -> Array:
        """B: what the actuators that err add to the interface per command, shape (p, p)."""
        size = self.partition.degrees
        kinematics = np.eye(size) if self.kinematics is None else self.kinematics
        errs = np.eye(size) if self.actuator is None else np.zeros((size, size))
        if self.actuator is not None:
            moves, follows = self.actuator if isinstance(self.actuator, tuple) else (self.actuator,) * 2
            errs[moves, follows] = 1.0
        return np.asarray(np.linalg.solve(kinematics, errs @ kinematics))

    def cells(self, *, gain: object, delay: object) -> FrameCells:
        """Actuators of given gains [-] and delays [s], which are broadcast and flattened."""
        gains, delays = np.broadcast_arrays(np.asarray(gain, dtype=float), np.asarray(delay, dtype=float))
        return FrameCells(gain=gains.ravel(), delay=delays.ravel())

    @cached_property
    def step(self) -> float:
        """Longest step [s] that resolves the modes; with one actuator the record's, divided."""
        fastest = 2.0 * np.pi * float(self.partition.natural_frequencies[-1])
        slowest_phase = _PHASE_STEP / self.structure.circular_frequency
        longest = min(_LONGEST_STEP, slowest_phase, max(_SHORTEST_STEP, _FASTEST_PHASE_STEP / fastest))
        record_step = self.excitation.time_step
        return record_step / int(np.ceil(record_step / longest - 1e-9)) if self._has_one_actuator else longest

    @cached_property
    def exact(self) -> ExactLoop:
        """Engine "spectral"."""
        return ExactLoop(
            excitation=self.excitation,
            partition=self.partition.nonsingular_form,
            erring=self._erring,
            output=self.output,
            longest_step=self.step,
            lead=float(longest_lead(self.governing_mode)),
        )

    @cached_property
    def reduced_loop(self) -> ReducedLoop:
        """Engine "pole", for one actuator."""
        return ReducedLoop(
            excitation=self.excitation,
            partition=self.partition.nonsingular_form,
            output=self.output,
            step=self.step,
        )

    def deviation(self, cells: FrameCells) -> Deviation:
        """Deviation of the response from that of the undivided frame over the window.

        Returns mean square and peak of each cell. Beyond every threshold (infinite) where the test is
        unstable and its poles could not be followed.
        """
        if self.engine is Engine.SPECTRAL or not self._has_one_actuator:
            return self.exact.deviation(cells.gain, cells.delay)
        poles = self.reduced_loop.poles(cells.gain, cells.delay)
        deviation = self.reduced_loop.deviation(poles)
        if self.engine is Engine.POLE:
            return deviation
        inexact = self.reduced_loop.error(poles, cells.gain, cells.delay) > REDUCTION_TOLERANCE
        if inexact.any():
            inexact &= self.reduced_loop.stable(cells.gain, cells.delay)
        if inexact.any():
            deviation.put(inexact, self.exact.deviation(cells.gain[inexact], cells.delay[inexact]))
        return deviation

    def rest_deviation(self) -> Deviation:
        """Deviation of actuators that do not move: the computer then moves what is left to it alone.

        That part may be free to drift, as where the whole stiffness of a storey stands in the laboratory.
        """
        return self.exact.rest_deviation()

    @property
    def is_output(self) -> NDArray[np.bool_]:
        """Which responses are judged, shape (p,), or (1,) of an output."""
        return self.exact.is_output

    def response(self, actuators: TransferSystem | ActuatorMatrix) -> RigResponse:
        """Histories of the test with actuators that are known over frequency, at fine steps."""
        return replace(self.exact, longest_step=_STEP_OF_RIG, lead=0.0).response(actuators)
