"""Where the error of a test with several actuators comes from: by actuator, and by cause.

Each measured displacement is written by penalised least squares as m_i = Σ_j (k_ij c_j − τ_ij c_j') +
constant + rest. The error is linear in c − m, so that each part is rebuilt by itself ::

    gain (1 − k_ii) c_i,   delay τ_ii c_i',   cross-coupling −Σ_{j≠i}(k_ij c_j − τ_ij c_j'),   the rest

Together with a force that was fed back late they add up to the error.
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.assessment.coupled_error.coupled_histories import CoupledHistories
from reliab.assessment.rebuilt_error.parts import Part, part_of
from reliab.assessment.rebuilt_error.recursion import respond

CAUSES = ("gain", "delay", "cross_coupling", "rest")

FED_BACK_FORCE = "fed_back_force"

_ROUNDING = 1e-12
_OWN, _OF_OTHERS = 1e-3, 3e-3  # of a command: errors that large are as dear as what they leave unexplained


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledParts:
    """The error divided into parts."""

    gain: Array  # k of least squares [-], shape (p, p)
    delay: Array  # τ of least squares [s], shape (p, p)
    histories: dict[str, Array]  # Contribution of each part to x_m − x_I [m], shape (p, n)
    reference: Array  # x_I [m], shape (p, n)

    def of_degree(self, place: int) -> dict[str, Part]:
        """Parts of the error of one interface displacement, such as "actuator_1_gain"."""
        whole = np.sum([history[place] for history in self.histories.values()], axis=0)
        peak = max(float(np.abs(self.reference[place]).max()), np.finfo(float).tiny)
        return {name: part_of(history[place], whole, peak) for name, history in self.histories.items()}

    def first(self, place: int) -> str:
        """Return the part to improve first: the one whose removal leaves the smallest error."""
        parts = self.of_degree(place)
        return min(parts, key=lambda name: parts[name].remaining_rms)


def divide(histories: CoupledHistories) -> CoupledParts:
    """Divide a rebuilt error into its parts."""
    command, measured, step = histories.command, histories.measured, histories.time_step
    velocity = np.gradient(command, step, axis=1)
    gain, delay = _followed(command, velocity, measured)
    recursion = histories.recursion
    parts = {
        name: respond(recursion, difference) - difference
        for name, difference in _differences(histories, velocity, gain, delay)
    }
    still = np.zeros_like(command)
    parts["actuator_1_rest"] += respond(recursion, still, recursion.static @ histories.standing)
    late = histories.fed_back - histories.difference
    if np.abs(late).max() > _ROUNDING * np.abs(measured).max():
        parts[FED_BACK_FORCE] = respond(recursion, late)
    response = histories.respond(recursion, histories.fed_back)
    return CoupledParts(
        gain=gain, delay=delay, histories=parts, reference=histories.carry @ command - response
    )


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
        own = np.arange(2 * size) % size == place
        penalty = np.where(own, _OWN, _OF_OTHERS) ** 2
        missed = scaled @ (measured[place] - command[place]) / rows.shape[1]
        followed[place] = np.linalg.solve(normal + np.diag(penalty), missed) / scale
    return np.eye(size) + followed[:, :size], followed[:, size:]


def _differences(
    histories: CoupledHistories, velocity: Array, gain: Array, delay: Array
) -> list[tuple[str, Array]]:
    """Parts of τ at the interface [m], by name."""
    command, difference = histories.command, histories.command - histories.measured
    parts = []
    for place in range(command.shape[0]):
        apart = np.arange(command.shape[0]) != place
        rows = {
            "gain": (1.0 - gain[place, place]) * command[place],
            "delay": delay[place, place] * velocity[place],
            "cross_coupling": delay[place, apart] @ velocity[apart] - gain[place, apart] @ command[apart],
        }
        rows["rest"] = difference[place] - np.sum(list(rows.values()), axis=0)
        parts += [
            (f"actuator_{place + 1}_{cause}", np.outer(histories.carry[:, place], rows[cause]))
            for cause in CAUSES
        ]
    return parts
