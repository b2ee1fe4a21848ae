"""The numbers of a monitor in a loop: its recursion, and the modes whose energy it watches.

With one actuator the recursion is that of `reliab.assessment.rebuilt_error`, with several that of
`reliab.assessment.coupled_error`; both have one form, w₊ = E w + F₀τ + F₁τ₊, y = P w + Qτ, with τ = x_c − x_m
at the interface.
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.assessment.coupled_error import CoupledRecursion
from reliab.assessment.rebuilt_error import (
    Recursion,
    WatchedMode,
    WholeStructure,
    equilibrium,
    modes_of_structure,
    watched_modes,
)
from reliab.structures import CoupledPartition


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

    @classmethod
    def of_one_actuator(cls, structure: WholeStructure, step: float) -> "LoopCoefficients":
        """Take a structure with one interface; `step` [s]."""
        recursion = Recursion.of_displacement(structure, step)
        at_rest = structure.error_transfer(np.zeros(1, dtype=np.complex128)).real
        return cls(
            decay=recursion.decay,
            early=recursion.early[:, np.newaxis],
            late=recursion.late[:, np.newaxis],
            output=recursion.output,
            feed_through=recursion.feed_through[np.newaxis],
            carry=np.eye(1),
            equilibrium=equilibrium(structure, 1.0)[:, np.newaxis],
            share=at_rest,
            modes=modes_of_structure(structure, step),
        )

    @classmethod
    def of_several(cls, partition: CoupledPartition, carry: Array, step: float) -> "LoopCoefficients":
        """Take a structure with several interface displacements; `step` [s]."""
        whole = partition.with_masses
        recursion = CoupledRecursion.of_partition(whole, step)
        return cls(
            decay=recursion.transition,
            early=recursion.early,
            late=recursion.late,
            output=recursion.output,
            feed_through=recursion.feed_through,
            carry=carry,
            equilibrium=recursion.static @ carry,
            share=partition.shares_at_sensors(carry),
            modes=watched_modes(
                whole.mass,
                whole.damping,
                whole.stiffness,
                whole.interface,
                whole.specimen_stiffness,
                step,
            ),
        )
