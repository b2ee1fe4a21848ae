"""One structure with any number of actuators under one ground motion, ready to be solved for any of them.

The engine "spectral" is exact. With one actuator each cell is solved with the pole pairs of the test (engine
"pole"), which is faster; where the part that they neglect matters for the record at hand, and the test is
stable, the exact engine takes over.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.simulation.deviation import Deviation
from reliab.simulation.engine import Engine
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.exact_loop import ExactLoop, RigResponse
from reliab.simulation.frames.frame_file import governing_mode, scale_of_errors
from reliab.simulation.frames.reduced_loop import ReducedLoop
from reliab.simulation.transfer_systems.transfer_function import ActuatorMatrix, TransferSystem
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure, longest_lead

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
