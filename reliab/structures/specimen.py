"""A specimen of one degree of freedom, and the interface at which it is attached to a frame."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.physical_range import require_physical
from reliab.structures.frame import Frame


@dataclass(frozen=True, kw_only=True)
class Specimen:
    """The specimen without further effects: force = k·x + c·v + m·a of the piston's motion.

    >>> Specimen(stiffness=2000.0).damping
    0.0
    """

    stiffness: float  # Stiffness k [N/m], not negative
    damping: float = 0.0  # Damping coefficient c [N·s/m]
    mass: float = 0.0  # Moving mass m [kg], not negative

    def __post_init__(self) -> None:
        require_physical("stiffness", self.stiffness, zero=True, label="stiffness of the specimen")
        require_physical(
            "damping coefficient",
            self.damping,
            zero=True,
            signed=True,
            label="damping coefficient of the specimen",
        )
        require_physical("mass", self.mass, zero=True, label="mass of the specimen")


def floor_interface(frame: Frame, name: str | int) -> Array:
    """γ of a specimen between the ground and a degree of freedom, shape (n,)."""
    interface = np.zeros(frame.size)
    interface[frame.degree_of_freedom(name)] = 1.0
    return interface


def drift_interface(frame: Frame, upper: str | int, lower: str | int) -> Array:
    """γ of a specimen between two degrees of freedom, shape (n,).

    Raises InputError if both are the same.
    """
    interface = floor_interface(frame, upper)
    if frame.degree_of_freedom(lower) == frame.degree_of_freedom(upper):
        raise InputError(
            "A drift needs two different degrees of freedom",
            value=str(upper),
            remedy="Name the floors above and below the storey",
        )
    interface[frame.degree_of_freedom(lower)] = -1.0
    return interface


def add_specimen(frame: Frame, interface: Sequence[float] | Array, specimen: Specimen) -> Frame:
    """Return the frame with a specimen added at an interface: the whole of which it is then a part."""
    interface_product = np.outer(interface, interface)
    return Frame(
        mass=frame.mass + specimen.mass * interface_product,
        damping=frame.damping + specimen.damping * interface_product,
        stiffness=frame.stiffness + specimen.stiffness * interface_product,
        influence=frame.influence,
        names=frame.names,
    )
