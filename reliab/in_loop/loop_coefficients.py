"""The numbers of a monitor in a loop: its recursion, and the modes whose energy it watches.

With one actuator the recursion is that of `reliab.assessment.rebuilt_error`, with several that of
`reliab.assessment.coupled_error`; both have one form, w₊ = E w + F₀τ + F₁τ₊, y = P w + Qτ, with τ = x_c − x_m
at the interface.
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.assessment.coupled_error import CoupledRecursion
from reliab.assessment.rebuilt_error import Damping, Recursion, WholeStructure, equilibrium
from reliab.structures import CoupledPartition

_TAKES_PART = 1e-6  # of the largest share of the specimen in a mode: a mode with less cannot become unstable


@dataclass(frozen=True, kw_only=True, eq=False)
class WatchedMode:
    """A mode whose energy is watched."""

    projection: Array  # By which interface displacements are carried to the mode [-], shape (p,)
    damping: Damping


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
    modes: tuple[WatchedMode, ...]  # As many as actuators

    @classmethod
    def of_one_actuator(cls, structure: WholeStructure, step: float) -> "LoopCoefficients":
        """Take a structure with one interface; `step` [s]."""
        recursion = Recursion.of_displacement(structure, step)
        at_rest = structure.error_transfer(np.zeros(1, dtype=np.complex128)).real
        damping = Damping.of_structure(structure, step)
        return cls(
            decay=recursion.decay,
            early=recursion.early[:, np.newaxis],
            late=recursion.late[:, np.newaxis],
            output=recursion.output,
            feed_through=recursion.feed_through[np.newaxis],
            carry=np.eye(1),
            equilibrium=equilibrium(structure, 1.0)[:, np.newaxis],
            share=at_rest,
            modes=(WatchedMode(projection=np.ones(1), damping=damping),),
        )

    @classmethod
    def of_several(cls, partition: CoupledPartition, carry: Array, step: float) -> "LoopCoefficients":
        """Take a structure with several interface displacements; `step` [s]."""
        recursion = CoupledRecursion.of_partition(partition.with_masses, step)
        return cls(
            decay=recursion.transition,
            early=recursion.early,
            late=recursion.late,
            output=recursion.output,
            feed_through=recursion.feed_through,
            carry=carry,
            equilibrium=recursion.static @ carry,
            share=partition.shares_at_sensors(carry),
            modes=_modes(partition, step),
        )


def _modes(partition: CoupledPartition, step: float) -> tuple[WatchedMode, ...]:
    """Modes of which the specimen holds the largest shares of the stiffness.

    In a mode that moves the interface by ν, errors x_m − x_c work as the modal force νᵀK_e(x_m − x_c), and a
    motion of that mode alone has the coordinate νᵀK_e x_c/(νᵀK_e ν).
    """
    frequency, ratio, shapes = partition.modes
    loads = partition.specimen_stiffness @ shapes
    stiffness = np.einsum("pm,pm->m", shapes, loads)
    shares = stiffness / (2.0 * np.pi * frequency) ** 2
    places = np.argsort(-shares, kind="stable")[: partition.degrees]
    places = np.where(shares[places] > _TAKES_PART * shares.max(), places, places[0])
    return tuple(
        WatchedMode(
            projection=loads[:, place] / stiffness[place],
            damping=Damping.of_mode(
                2.0 * np.pi * float(frequency[place]), float(ratio[place]), float(stiffness[place]), step
            ),
        )
        for place in places
    )
