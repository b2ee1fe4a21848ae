"""One partitioned frame under one ground motion, ready to be solved for any actuator.

Each cell is solved with the pole pairs of the test (engine "pole"). Where the part that they neglect matters
for the record at hand, and the test is stable, the cell is solved in the frequency domain (engine
"spectral"), which is exact and the reference against which the other engine is tested.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array, Spectrum
from reliab.errors import InputError
from reliab.significant import significant
from reliab.simulation.deviation import Deviation, peak_of_history, summary
from reliab.simulation.engine import Engine
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.loop_poles import PoleLoop, pole_loop, transfer
from reliab.simulation.frames.mode_recursion import LANES, recursion, track
from reliab.simulation.linear_loop.spectral import respond
from reliab.structures import Partition, Structure
from reliab.structures.critical_delay import critical_delay
from reliab.structures.frames import undivided_response

_COMPARED = 61

_HIGHEST = 100.0  # Hz, above which the content of records is neglected

_NO_DEVIATION = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameCells:
    """Actuators of given gains and delays before one partitioned frame."""

    partition: Partition  # The partitioned frame
    # gain, delay: Actuator gain k_p [-], positive, and delay τ [s], negative for a lead, shape (cells,) each
    gain: Array
    delay: Array
    # Weights of the degrees of freedom in the response whose error counts; by default it is the measured
    # interface displacement
    output: Array | None = None

    def __post_init__(self) -> None:
        sound = np.isfinite(self.gain) & np.isfinite(self.delay) & (self.gain > 0.0)
        if not sound.all():
            raise InputError(
                "Actuator gains must be positive and finite, delays finite",
                value=f"{self.gain[~sound][0]:g} and {self.delay[~sound][0]:g} s",
                remedy="Give gains as measured over command amplitude and delays in seconds",
            )

    @cached_property
    def stable(self) -> NDArray[np.bool_]:
        """Whether the delay of each cell is below the critical delay, as every lead is."""
        gains, places = np.unique(self.gain, return_inverse=True)
        limits = np.array([critical_delay(self.partition, gain)[0] for gain in gains.tolist()])
        return np.asarray(self.delay < limits[places])

    @cached_property
    def poles(self) -> PoleLoop:
        """Poles and residues of each cell."""
        return pole_loop(self.partition, self.gain, self.delay, self.output)

    @cached_property
    def frequencies(self) -> Array:
        """Frequencies [Hz] at which the reduction is compared with the exact loop, shape (bands,)."""
        modes = self.partition.frame.modes.frequency
        return np.geomspace(0.1 * modes[0], max(_HIGHEST, 4.0 * modes[0]), _COMPARED)

    @cached_property
    def reduction(self) -> tuple[Array, Array]:
        """Squared moduli of the reduction's error and of the deviation [s⁴], shape (bands, cells)."""
        s = (2j * np.pi * self.frequencies).astype(np.complex128)
        exact = transfer(self.partition, self.gain, self.delay, s, self.output)
        ideal = transfer(self.partition, np.ones(1), np.zeros(1), s, self.output)
        neglected = np.abs(exact - self.poles.transfer(s)) ** 2
        total = np.maximum(np.abs(exact - ideal), _NO_DEVIATION * np.abs(ideal)) ** 2
        return np.where(np.isfinite(neglected), neglected, np.inf), total


REDUCTION_TOLERANCE = 3e-3
"""Largest relative error of RMS^R that the reduction to pole pairs may cause [-]."""

_PHASE_STEP = 0.09  # rad of the governing mode in a step: its sampled peak is then within 1e-3
_FASTEST_PHASE_STEP = 0.6  # rad of the highest mode, which contributes little to the response
_SHORTEST_STEP = 0.002
_LONGEST_STEP = 0.01


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameLoop:
    """A partitioned frame under one ground motion.

    >>> from reliab.shipped import shipped
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
        if self.engine not in {Engine.AUTOMATIC, Engine.POLE, Engine.SPECTRAL}:
            raise InputError(
                "A frame is solved by the engines automatic, pole or spectral", value=self.engine
            )
        if self.output is not None and np.shape(self.output) != (self.partition.frame.size,):
            raise InputError(
                f"An output needs {self.partition.frame.size} weights", value=np.shape(self.output)
            )

    @property
    def governing_mode(self) -> Structure:
        """The mode that governs the error."""
        return governing_mode(self.partition, self.output)

    @property
    def structure(self) -> Structure:
        """One-mode structure that sets the scale of gains and delays: the mode that governs the error.

        Its frequency is that of the mode and its damping ratio ξ/α with the specimen's share α in the mode,
        so that errors of the actuator matter as much as in the frame.
        """
        frame, place = self.partition.frame, self.governing(self.partition, self.output)
        share = min(float(np.abs(self.partition.impedance_shares[place])), 1.0)
        # Amplitude errors count as far as the specimen's share of the mode; ξ/α is their scale.
        scale = float(frame.damping_ratios[place]) / max(share, 1e-3)
        return Structure(
            frequency=float(frame.modes.frequency[place]), damping_ratio=float(np.clip(scale, 1e-4, 0.5))
        )

    @staticmethod
    def governing(partition: Partition, output: Array | None) -> int:
        """Place of the mode whose share of the output suffers most from an error of the actuator."""
        frame, modes = partition.frame, partition.frame.modes
        share = np.abs(partition.impedance_shares)
        seen = partition.direction if output is None else output
        moved = np.abs(seen @ modes.shapes) * np.abs(modes.shapes.T @ frame.mass @ frame.influence)
        # The response of a mode to a given ground acceleration goes with 1/ω², its sensitivity with α/ξ.
        sensitivity = share / np.maximum(frame.damping_ratios, 1e-4) * moved / modes.circular_frequency**2
        return int(np.argmax(sensitivity))

    def cells(self, *, gain: object, delay: object) -> FrameCells:
        """Actuators before this frame; gain [-] and delay [s] are broadcast and flattened."""
        gains, delays = np.broadcast_arrays(np.asarray(gain, dtype=float), np.asarray(delay, dtype=float))
        return FrameCells(
            partition=self.partition, gain=gains.ravel(), delay=delays.ravel(), output=self.output
        )

    @cached_property
    def step(self) -> float:
        """Step [s]: the record's step divided so that the modes are resolved."""
        fastest = float(self.partition.frame.modes.circular_frequency[-1])
        longest = longest_step(self.structure.circular_frequency, fastest)
        return self.excitation.time_step / int(np.ceil(self.excitation.time_step / longest - 1e-9))

    @cached_property
    def _sampled(self) -> tuple[Array, int]:
        """Ground acceleration at the steps up to the end of the window, and the step at which it begins."""
        begin, end = self.excitation.window
        times = self.step * np.arange(round(end / self.step) + 1)
        recorded = self.excitation.time_step * np.arange(self.excitation.acceleration.size)
        return np.interp(times, recorded, self.excitation.acceleration), round(begin / self.step)

    @cached_property
    def ideal(self) -> Array:
        """Exact response of the output [m] at the steps."""
        floors = undivided_response(self.partition.frame, self._sampled[0], self.step)
        seen = self.partition.direction if self.output is None else self.output
        return np.ascontiguousarray(seen @ floors)

    @property
    def ideal_peak(self) -> float:
        """Largest exact response [m] in the window."""
        return peak_of_history(self.ideal[self._sampled[1] :])

    @cached_property
    def _band_power(self) -> Array:
        frequencies = self.cells(gain=1.0, delay=0.0).frequencies
        half = np.sqrt(frequencies[1] / frequencies[0])
        return self.excitation.band_power(np.append(frequencies / half, frequencies[-1] * half))

    def reduction_error(self, cells: FrameCells) -> Array:
        """Relative error of RMS^R that the reduction causes for this record [-], shape (cells,)."""
        neglected, total = cells.reduction
        with np.errstate(invalid="ignore"):
            error = np.sqrt(self._band_power @ neglected / np.maximum(self._band_power @ total, 1e-300))
        return np.where(np.isnan(error), np.inf, error)

    def deviation(self, cells: FrameCells) -> Deviation:
        """Deviation of the output from that of the undivided frame over the window.

        Returns mean square and peak of each cell. Beyond every threshold (infinite) where the test is
        unstable and its poles could not be followed.
        """
        if self.engine is Engine.SPECTRAL:
            return self._exact(cells)
        deviation = self._reduced(cells)
        if self.engine is Engine.POLE:
            return deviation
        again = self.reduction_error(cells) > REDUCTION_TOLERANCE
        if again.any():
            again &= cells.stable
        if again.any():
            exact = self._exact(self.cells(gain=cells.gain[again], delay=cells.delay[again]))
            deviation.mean_square[again], deviation.peak[again] = exact.mean_square, exact.peak
        return deviation

    def at_rest(self) -> Deviation:
        """Deviation of an actuator that does not move: the computer then moves what is left to it alone.

        That part may be free to drift, as where the whole stiffness of a storey stands in the laboratory.
        """
        ideal, step = self._solved(1.0, 0.0)
        return self._strayed([self._solved(0.0, 0.0)[0]], ideal, step)

    def _reduced(self, cells: FrameCells) -> Deviation:
        ground, first = self._sampled
        missing = -cells.gain.size % LANES
        with np.errstate(all="ignore"):  # a violently unstable cell may overflow, or its poles be unknown
            coefficients = recursion(cells.poles, self.step)
            filled = np.pad(coefficients, ((0, 0), (0, 0), (0, missing)), mode="edge")
            tracks = track(ground, self.ideal, first, np.ascontiguousarray(filled))[:, : cells.gain.size]
            deviation = summary(tracks, float(ground.size - 1 - first), self.ideal_peak)
        return replace(
            deviation,
            mean_square=np.nan_to_num(deviation.mean_square, nan=np.inf, posinf=np.inf),
            peak=np.nan_to_num(deviation.peak, nan=np.inf, posinf=np.inf),
        )

    def response(self, gain: float, delay: float, *, longest: float | None = None) -> tuple[Array, float]:
        """Exact response of the output with one actuator, inside the window.

        `longest` [s]; returns response [m], step [s].
        """
        limit, frequency = critical_delay(self.partition, gain)
        if delay >= limit:
            raise InputError(
                f"The spectral engine needs a delay below the critical delay, which is {1e3 * limit:.6g} ms "
                f"(at {significant(frequency)} Hz) for k_p = {gain:g}",
                value=f"{1e3 * delay:.6g} ms",
                remedy="Use a stepping engine for an unstable test",
            )
        return self._solved(gain, delay, longest)

    def _solved(self, gain: float, delay: float, longest: float | None = None) -> tuple[Array, float]:
        """Exact response of a test that is not unstable, and its step."""
        function = partial(_column, self.partition, gain, delay, self.output)
        return respond(self.excitation, function, longest=longest or self.step)

    def _exact(self, cells: FrameCells) -> Deviation:
        ideal, step = self._solved(1.0, 0.0)
        actuators = zip(cells.gain.tolist(), cells.delay.tolist(), strict=True)
        return self._strayed((self.response(gain, delay)[0] for gain, delay in actuators), ideal, step)

    def _strayed(self, responses: Iterable[Array], ideal: Array, step: float) -> Deviation:
        """Deviation of exact responses, one at a time, from the undivided frame's."""
        strayed = (response - ideal for response in responses)
        sizes = [(np.trapezoid(history**2, dx=step), peak_of_history(history)) for history in strayed]
        squares, peaks = np.array(sizes).T
        return Deviation(
            mean_square=squares / self.excitation.window_duration,
            peak=peaks,
            ideal_peak=peak_of_history(ideal),
        )


def longest_step(governing: float, fastest: float) -> float:
    """Longest step [s] that resolves the governing mode and the fastest one, both [rad/s]."""
    return min(_LONGEST_STEP, _PHASE_STEP / governing, max(_SHORTEST_STEP, _FASTEST_PHASE_STEP / fastest))


def governing_mode(partition: Partition, output: Array | None = None) -> Structure:
    """Frequency, damping ratio and share of the specimen of the mode that governs the error of a frame."""
    place = FrameLoop.governing(partition, output)
    share = abs(float(partition.impedance_shares[place].real))
    return Structure(
        frequency=float(partition.frame.modes.frequency[place]),
        damping_ratio=float(partition.frame.damping_ratios[place]),
        experimental_fraction=float(np.clip(share, 1e-6, 1.0)),
    )


def _column(partition: Partition, gain: float, delay: float, output: Array | None, s: Spectrum) -> Spectrum:
    return transfer(partition, np.array([gain]), np.array([delay]), s, output)[:, 0]
