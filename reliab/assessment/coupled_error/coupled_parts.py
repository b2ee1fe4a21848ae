"""Where the error of a test with several actuators comes from: by actuator, and by cause.

Each measured displacement is written by penalised least squares as m_i = Σ_j (k_ij c_j − τ_ij c_j') +
constant + rest. The error is linear in c − m, so that each part is rebuilt by itself ::

    gain (1 − k_ii) c_i,   delay τ_ii c_i',   cross-coupling −Σ_{j≠i}(k_ij c_j − τ_ij c_j'),   the rest

Together with a force that was fed back late they add up to the error.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.parts import Parts, parts_of, pieces_of
from reliab.assessment.rebuilt_error.readings import delayed
from reliab.assessment.rebuilt_error.recursion import Recursion, respond

CAUSES = ("gain", "delay", "cross_coupling", "rest")

_BY_ITSELF, _OF_OTHERS = (
    1e-3,
    3e-3,
)  # of a command: errors that large are as dear as what they leave unexplained


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledHistories:
    """Smoothed histories at the sensors, without their offsets."""

    command: Array  # command, measured: At the sensors [m], shape (p, n)
    measured: Array
    carry: Array  # From sensors to the interface [-], shape (p, p)
    feedback_lag: float  # s
    time_step: float  # s
    standing: Array  # At the interface [m], shape (p,)
    recursion: Recursion  # Of the ideal test from sample to sample

    @cached_property
    def difference(self) -> Array:
        """τ at the interface [m], shape (p, n)."""
        return np.asarray(self.carry @ (self.command - self.measured))

    @cached_property
    def fed_back(self) -> Array:
        """Command minus the displacement whose force was fed back, at the interface [m], shape (p, n)."""
        felt = np.stack([delayed(row, self.feedback_lag, self.time_step) for row in self.measured])
        return np.asarray(self.carry @ (self.command - felt))

    @cached_property
    def response(self) -> Array:
        """Answer e of the interface to the test as recorded [m], shape (p, n)."""
        return self.respond(self.recursion, self.fed_back)

    def respond(self, recursion: Recursion, differences: Array) -> Array:
        """Answer e of the interface to τ, which begins where the structure stood [m]."""
        return respond(recursion, differences, recursion.static @ self.standing)


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledParts:
    """The error divided into parts."""

    gain: Array  # k of least squares [-], shape (p, p)
    delay: Array  # τ of least squares [s], shape (p, p)
    histories: dict[str, Array]  # Contribution of each part to x_m − x_I [m], shape (p, n)
    reference: Array  # x_I [m], shape (p, n)

    def of_degree(self, place: int) -> Parts:
        """Parts of the error of one interface displacement, such as "actuator_1_gain"."""
        pieces = {name: history[place] for name, history in self.histories.items()}
        peak = max(float(np.abs(self.reference[place]).max()), np.finfo(float).tiny)
        return parts_of(self.gain, self.delay, pieces, peak)


def divide(histories: CoupledHistories) -> CoupledParts:
    """Divide a rebuilt error into its parts."""
    command, measured, step = histories.command, histories.measured, histories.time_step
    velocity = np.gradient(command, step, axis=1)
    gain, delay = _followed(command, velocity, measured)
    pieces = pieces_of(
        histories.recursion,
        _differences(histories, velocity, gain, delay),
        histories.fed_back - histories.difference,
        standing=histories.standing,
        remainder="actuator_1_rest",
        measured=measured,
    )
    reference = histories.carry @ command - histories.response
    return CoupledParts(gain=gain, delay=delay, histories=pieces, reference=reference)


def _followed(command: Array, velocity: Array, measured: Array) -> tuple[Array, Array]:
    """Gains and delays of least squares, those of actuator i in row i.

    Commands that move alike do not tell whose error it is: the smallest errors are taken that explain the
    test, and an actuator's own before those that others cause.
    """
    rows = np.vstack([command, -velocity])
    rows = rows - rows.mean(axis=1, keepdims=True)
    scale = np.maximum(np.sqrt(np.mean(rows**2, axis=1)), np.finfo(float).tiny)
    scaled = rows / scale[:, np.newaxis]
    normal = scaled @ scaled.T / rows.shape[1]
    size = command.shape[0]
    followed = np.empty((size, 2 * size))
    for place in range(size):
        diagonal = np.arange(2 * size) % size == place
        penalty = np.where(diagonal, _BY_ITSELF, _OF_OTHERS) ** 2
        missed = scaled @ (measured[place] - command[place]) / rows.shape[1]
        followed[place] = np.linalg.solve(normal + np.diag(penalty), missed) / scale
    return np.eye(size) + followed[:, :size], followed[:, size:]


def _differences(histories: CoupledHistories, velocity: Array, gain: Array, delay: Array) -> dict[str, Array]:
    """Parts of τ at the interface [m], by name."""
    command, difference = histories.command, histories.command - histories.measured
    parts: dict[str, Array] = {}
    for place in range(command.shape[0]):
        apart = np.arange(command.shape[0]) != place
        rows = {
            "gain": (1.0 - gain[place, place]) * command[place],
            "delay": delay[place, place] * velocity[place],
            "cross_coupling": delay[place, apart] @ velocity[apart] - gain[place, apart] @ command[apart],
        }
        rows["rest"] = difference[place] - np.sum(list(rows.values()), axis=0)
        parts |= {
            f"actuator_{place + 1}_{cause}": np.outer(histories.carry[:, place], rows[cause])
            for cause in CAUSES
        }
    return parts
