"""Degrees of freedom that nobody measured: they follow from the interface and the ground motion.

With x = N q + P y, where Γᵀ N = 0 and P = M⁻¹Γ(ΓᵀM⁻¹Γ)⁻¹, whatever acts at the interface drops out of ::

    NᵀMN q'' + NᵀCN q' + NᵀKN q = −Nᵀ(M ι a_g + C P y' + K P y),

and neither specimen nor actuator has a part in how the others follow an interface displacement y.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from reliab.assessment.rebuilt_error.recursion import Recursion, respond
from reliab.core.arrays import Array
from reliab.core.threads import one_thread
from reliab.structures.frame import exact_step
from reliab.structures.partition import Partition

_NO_MASS = 1e-9  # of the largest mass
_LIGHT = 0.5  # natural frequency of a degree of freedom without mass times the time step, in radians


@dataclass(frozen=True, kw_only=True, eq=False)
class Substructures:
    """A structure, and how specimen and computer share it.

    `mass` of the whole, `damping` and `stiffness` of the computer's part, shape (n, n); `interface` Γ, shape
    (n, p), `influence` ι, shape (n,) [-]; `of_specimen`: its linear stiffness, damping and mass, each (p, p).
    """

    mass: Array
    damping: Array
    stiffness: Array
    interface: Array
    influence: Array
    of_specimen: tuple[Array, Array, Array]

    @classmethod
    def from_partition(cls, partition: Partition) -> "Substructures":
        """Take a frame with its specimen."""
        numerical = partition.numerical_substructure
        return cls(
            mass=partition.mass,
            damping=numerical.damping,
            stiffness=numerical.stiffness,
            interface=partition.interface,
            influence=partition.influence,
            of_specimen=(
                partition.specimen_stiffness,
                partition.specimen_damping,
                partition.specimen_mass,
            ),
        )

    @property
    def size(self) -> int:
        """Number n of degrees of freedom."""
        return int(self.mass.shape[0])

    @property
    def all_driven(self) -> bool:
        """Whether the interface is the whole structure, so that no ground motion is needed."""
        return bool(self.size == self.interface.shape[1])

    @cached_property
    def bare(self) -> Array:
        """Which degrees of freedom have no mass, shape (n,)."""
        return np.asarray(np.abs(self.mass).max(axis=1) <= _NO_MASS * np.abs(self.mass).max())

    def force_of_linear(self, interface_displacements: Array, step: float) -> tuple[Array, Array]:
        """Force of the linear specimen along a path [N], without the inertia of its mass and with it."""
        stiffness, damping, mass = self.of_specimen
        velocity = np.gradient(interface_displacements, step, axis=1)
        force = stiffness @ interface_displacements + damping @ velocity
        return force, force + mass @ np.gradient(velocity, step, axis=1)

    def displacements(self, interface_displacements: Array, ground: Array | None, step: float) -> Array:
        """All displacements [m], shape (n, samples), while the interface moves like this, (p, samples).

        `ground`: acceleration [m/s²], shape (samples,), without which only a structure that is all driven is
        known; what is not driven stands still at the first sample.
        """
        mass = self.mass + np.diag(self.bare * np.diag(self.stiffness) * (step / _LIGHT) ** 2)
        compliance_shapes = np.linalg.solve(mass, self.interface)
        static_shapes = compliance_shapes @ np.linalg.inv(self.interface.T @ compliance_shapes)
        if self.all_driven or ground is None:
            return np.asarray(static_shapes @ interface_displacements)
        free = scipy.linalg.null_space(self.interface.T)
        velocity = np.gradient(interface_displacements, step, axis=1)
        loads = mass @ np.outer(self.influence, ground)
        loads += (
            self.damping @ static_shapes @ velocity + self.stiffness @ static_shapes @ interface_displacements
        )
        inner = [free.T @ matrix @ free for matrix in (mass, self.damping, self.stiffness)]
        inner_motion = _follow(inner, -free.T @ loads, step)
        return np.asarray(free @ inner_motion + static_shapes @ interface_displacements)

    def accelerations(self, displacements: Array, force: Array, step: float) -> Array:
        """Absolute accelerations [m/s²], shape (n, samples): what springs, dashpots and specimen exert.

        `force` without the inertia of the specimen's mass [N], shape (p, samples). Zero where no mass is.
        """
        velocity = np.gradient(displacements, step, axis=1)
        forces = self.damping @ velocity + self.stiffness @ displacements + self.interface @ force
        heavy = ~self.bare.astype(bool)
        answer = np.zeros_like(displacements)
        answer[heavy] = -np.linalg.solve(self.mass[np.ix_(heavy, heavy)], forces[heavy])
        return answer

    def force_of_computer(self, displacements: Array, ground: Array, step: float) -> Array:
        """Force that the equation of the computer's part leaves for the specimen [N], shape (p, samples)."""
        mass = self.interface @ self.of_specimen[2] @ self.interface.T
        numerical = self.mass - mass
        velocity = np.gradient(displacements, step, axis=1)
        absolute = np.gradient(velocity, step, axis=1) + np.outer(self.influence, ground)
        forces = numerical @ absolute + mass @ np.outer(self.influence, ground)
        forces += self.damping @ velocity + self.stiffness @ displacements
        return np.asarray(-np.linalg.lstsq(self.interface, forces, rcond=None)[0])


def _follow(matrices: list[Array], force: Array, step: float) -> Array:
    """Move under a force that is linear between samples, from where it stands still [m]."""
    mass, damping, stiffness = matrices
    size = mass.shape[0]
    state_rows = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
    dynamics = np.vstack([np.eye(size, 2 * size, size), state_rows])
    loads = np.vstack([np.zeros((size, size)), np.linalg.inv(mass)])
    with one_thread():
        transition, early, late = exact_step(dynamics, loads, step)
    recursion = Recursion(
        transition=transition,
        early=early,
        late=np.ascontiguousarray(late),
        output=np.eye(size, 2 * size),
        feed_through=np.zeros((size, size)),
        static=np.vstack([np.linalg.inv(stiffness), np.zeros((size, size))]),
    )
    start = np.concatenate([np.linalg.solve(stiffness, force[:, 0]), np.zeros(size)])
    return respond(recursion, force, start)
