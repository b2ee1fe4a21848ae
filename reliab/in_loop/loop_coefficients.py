"""The numbers of a monitor in a loop: its recursion, and the modes whose energy it watches.

The recursion is that of `reliab.assessment.rebuilt_error`, w₊ = E w + F₀τ + F₁τ₊, y = P w + Qτ, with
τ = x_c − x_m at the interface.
"""

from dataclasses import dataclass

from reliab.arrays import Array
from reliab.assessment.rebuilt_error import Recursion, WatchedMode, watched_modes
from reliab.structures import Partition


@dataclass(frozen=True, kw_only=True, eq=False)
class LoopCoefficients:
    """Coefficients of a monitor of p actuators."""

    decay: Array  # E, shape (2n, 2n)
    early: Array  # early, late: F₀ and F₁, shape (2n, p)
    late: Array
    output: Array  # P, shape (p, 2n)
    feed_through: Array  # Q, shape (p, p)
    carry: Array  # Interface displacements per unit at each sensor [-], shape (p, p)
    equilibrium: Array  # State under a constant x_c − x_m of one at each sensor, shape (2n, p)
    share: Array  # By which a sensor's offset that the loop feels moves its command back [-], shape (p,)
    modes: tuple[WatchedMode, ...]  # Three for each actuator at most

    pushed: tuple[Array, Array]  # F₀ and F₁ of a force at the interface, shape (2n, p) each

    @classmethod
    def of_structure(cls, structure: Partition, carry: Array, step: float) -> "LoopCoefficients":
        """Take a structure with interface displacements that the channels are carried to; `step` [s]."""
        whole = structure.with_masses
        recursion, by_force = Recursion.of_displacement(whole, step), Recursion.of_force(whole, step)
        return cls(
            decay=recursion.transition,
            early=recursion.early,
            late=recursion.late,
            output=recursion.output,
            feed_through=recursion.feed_through,
            carry=carry,
            equilibrium=recursion.static @ carry,
            share=structure.shares_at_sensors(carry),
            modes=watched_modes(whole, step),
            pushed=(by_force.early, by_force.late),
        )
