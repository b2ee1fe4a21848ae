"""The loop with further effects, stepped in time for many actuators."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.effects.effect import Role
from reliab.simulation.excitation import Deviation, Excitation, peak_of_history
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.linear_loop.cells import Cells
from reliab.structures.structure import Structure

LARGEST_PHASE_STEP = 0.04
"""Largest ω₀h of a step [rad]: a and b of a linear loop are then within 1e-3 of those of the exact one."""

LONGEST_STEP = 0.01
"""Longest step [s], so that the response of a soft structure above its own frequency is resolved too."""


@dataclass(frozen=True, kw_only=True)
class EffectLoop:
    """A hybrid test with effects under one ground motion, ready to be run with any actuator.

    The exact response is that of the same loop with a perfect rig: an actuator of gain 1 without delay, and
    without effects other than those of the specimen and of the shaking. What the specimen does, and how
    it was shaken, is the behaviour under test, while a lag, an offset or an integration error spoils the
    test. Gain k_p and delay τ of the cells are
    those of the actuator alone; effects on the way to the piston come on top of them.

    Raises InputError if the model has no structure.

    >>> from reliab.effects.registry import find_effect
    >>> record = np.sin(2 * np.pi * np.arange(0, 20, 0.01))
    >>> lag = find_effect("first_order_lag")(time_constant_s=0.002)
    >>> loop = EffectLoop(
    ...     excitation=Excitation(acceleration=record, time_step=0.01),
    ...     test=HybridTest(structure=Structure(frequency=1.0, damping_ratio=0.05), effects=(lag,)),
    ... )
    >>> found = loop.deviation(loop.cells(gain=1.0, delay=0.0))  # as a delay of 2 ms, 0.142
    >>> (found.peak / found.ideal_peak).round(2)
    array([0.14])
    """

    excitation: Excitation  # Record and window
    test: HybridTest  # The model, with a structure; gain and delay of its own actuator are ignored
    phase_step: float = LARGEST_PHASE_STEP  # Largest ω₀h of a step [rad]

    def __post_init__(self) -> None:
        if self.test.structure is None:
            raise InputError(
                "The error of a whole test needs a numerical substructure",
                remedy="Add a [structure] table to the model",
            )

    @property
    def structure(self) -> Structure:
        """The structure under test."""
        if self.test.structure is None:
            raise AssertionError  # checked when the loop was created
        return self.test.structure

    def cells(self, *, gain: object, delay: object) -> Cells:
        """Actuators before this structure; gain [-] and delay [s] are broadcast and flattened."""
        gains, delays = np.broadcast_arrays(np.asarray(gain, dtype=float), np.asarray(delay, dtype=float))
        return Cells(structure=self.structure, gain=gains.ravel(), delay=delays.ravel())

    @cached_property
    def _sample_excitation(self) -> tuple[Array, float]:
        """Ground acceleration [m/s²] at steps [s] that suit the structure and fit those of the record."""
        longest = min(LONGEST_STEP, self.phase_step / self.structure.circular_frequency)
        step = self.excitation.time_step
        ratio = step / longest
        step = step / np.ceil(ratio) if ratio > 1.0 else step * np.floor(1.0 / ratio)
        record_times = np.arange(self.excitation.acceleration.size) * self.excitation.time_step
        times = np.arange(int(record_times[-1] / step + 1e-9) + 1) * step
        return np.interp(times, record_times, self.excitation.acceleration), float(step)

    @cached_property
    def _window_slice(self) -> slice:
        begin, end = self.excitation.window
        step = self._sample_excitation[1]
        return slice(int(np.ceil(begin / step - 1e-9)), int(end / step + 1e-9) + 1)

    def _reading(self, test: HybridTest) -> Array:
        ground, step = self._sample_excitation
        return run_closed_loop(test, ground, step).measured[self._window_slice]

    @cached_property
    def exact(self) -> Array:
        """Displacement of the perfect rig [m] at the steps inside the window."""
        perfect = replace(self.test, actuator=Actuator(), effects=self.test.acting(Role.FORCE, Role.RECORD))
        return self._reading(perfect)

    def deviation(self, cells: Cells) -> Deviation:
        """Deviation of the measured displacement from that of the perfect rig over the window.

        `cells`: the actuators, before this loop's structure. Returns mean square and peak of each cell, in
        the order of the cells; NaN where the loop diverged. Raises InputError if an actuator leads: a loop
        with effects is marched in time and has no future values.
        """
        if cells.leads.any():
            raise InputError(
                "Effects cannot be simulated with an early actuator (a negative delay)",
                value=f"a lead of {-1e3 * cells.delay.min():.4g} ms",
                remedy="Give delays of zero or more, or leave the effects out",
            )
        exact = self.exact

        def statistics(actuator: Actuator) -> tuple[float, float]:
            difference = self._reading(replace(self.test, actuator=actuator)) - exact
            return float(np.trapezoid(difference**2) / (difference.size - 1)), peak_of_history(difference)

        pairs = zip(cells.gain.tolist(), cells.delay.tolist(), strict=True)
        actuators = [Actuator(gain=gain, delay=delay) for gain, delay in pairs]
        with ThreadPoolExecutor() as pool, np.errstate(over="ignore", invalid="ignore"):
            errors = np.array(list(pool.map(statistics, actuators)), dtype=np.float64).reshape(-1, 2)
        return Deviation(mean_square=errors[:, 0], peak=errors[:, 1], ideal_peak=peak_of_history(exact))

    def rest_deviation(self) -> Deviation:
        """Deviation of an actuator that does not move: zero displacement against that of the perfect rig."""
        squares, peak = self.exact**2, peak_of_history(self.exact)
        mean_square = float(np.trapezoid(squares) / (squares.size - 1))
        return Deviation(mean_square=np.array([mean_square]), peak=np.array([peak]), ideal_peak=peak)
