"""Actuators in a plane that are pinned to a rigid body: their displacements, exact for any rotation.

Actuator i is pinned to the body at r_i from its node and to the ground at r_i − L_i d_i, with d_i its
direction at rest. The body moves by u and turns by θ, its pin moves by w = u + (R(θ) − I)r_i, and it extends
by ::

    q_i = |L_i d_i + w| − L_i = (2 d_i·w + |w|²/L_i)/(|d_i + w/L_i| + 1)

which is d_i·w where it is long. Motions of the body follow from extensions by Newton's iteration.
"""

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant

_STEPS = 50
_CONVERGENCE_TOLERANCE = 1e-12
_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])
MOTIONS = ("x", "y", "rotation")
"""What an interface displacement may be: of the node along x or y [m], or a turn from x to y [rad]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanarGeometry:
    """Where actuators are pinned to a body that moves in a plane.

    The two actuators of the multi-axial benchmark, when the node turns by 0.1 rad:

    >>> pins = 0.29540 * np.array([[0.90285, -0.42994], [0.90285, 0.42994]])
    >>> along = np.array([[1.0, 0.0], [1.0, 0.0]])
    >>> geometry = PlanarGeometry(motions=("x", "rotation"), pins=pins, directions=along)
    >>> (1000.0 * geometry.extensions(np.array([[0.0], [0.1]]))).round(2).T
    array([[ 11.35, -14.01]])
    """

    motions: tuple[str, ...]  # What each interface displacement is
    pins: Array  # r_i [m], shape (actuators, 2)
    directions: Array  # d_i, in which an actuator extends, made unit vectors, shape (actuators, 2)
    lengths: Array | None = None  # L_i between the pins at rest [m], shape (actuators,); long by default

    def __post_init__(self) -> None:
        number, allowed_motions = len(self.motions), set(MOTIONS)
        if not allowed_motions.issuperset(self.motions) or len(set(self.motions)) != number:
            raise InputError(
                "The motions of a body in a plane are x, y and rotation, each once",
                value=list(self.motions),
                remedy="Name each of the three once",
            )
        directions, pins = (np.array(rows, dtype=np.float64) for rows in (self.directions, self.pins))
        lengths = np.full(number, np.inf) if self.lengths is None else np.array(self.lengths, dtype=float)
        if not directions.shape == pins.shape == (number, 2) or lengths.shape != (number,):
            raise InputError(
                f"The geometry needs pin, direction and length of {number} actuators, one for each motion",
                value=f"{len(pins)} pins, {len(directions)} directions and {lengths.size} lengths",
                remedy="Give two coordinates of each pin and direction",
            )
        size = np.linalg.norm(directions, axis=1)
        if not (np.isfinite([*pins.ravel(), *size]).all() and (size > 0.0).all() and (lengths > 0.0).all()):
            raise InputError(
                "Pins must be finite, directions not zero and lengths positive",
                value=f"directions {directions.tolist()} and lengths {lengths.tolist()} m",
                remedy="Check the numbers of [kinematics.geometry]",
            )
        object.__setattr__(self, "pins", pins)
        object.__setattr__(self, "directions", directions / size[:, np.newaxis])
        object.__setattr__(self, "lengths", lengths)

    @property
    def matrix(self) -> Array:
        """Extensions per unit of each small motion, shape (actuators, motions)."""
        return np.asarray(self._extend(np.zeros((len(self.motions), 1)))[1][0])

    def extensions(self, displacements: Array) -> Array:
        """Extensions of the actuators [m] at interface displacements [m, rad], shape (p, n) both."""
        return self._extend(displacements)[0]

    def displacements(self, extensions: Array) -> Array:
        """Interface displacements [m, rad] at extensions of the actuators [m], shape (p, n) both.

        Raises InputError where no motion of the body near its rest gives them.
        """
        with suppress(np.linalg.LinAlgError), np.errstate(all="ignore"):
            estimate: Array = np.asarray(np.linalg.solve(self.matrix, extensions), dtype=np.float64)
            for _ in range(_STEPS):
                reached_extensions, slopes = self._extend(estimate)
                step = np.linalg.solve(slopes, (extensions - reached_extensions).T[..., np.newaxis])[..., 0].T
                estimate = estimate + step
                if np.abs(step).max() <= _CONVERGENCE_TOLERANCE * max(np.abs(estimate).max(), 1.0):
                    return estimate
        raise InputError(
            "The actuators cannot reach these extensions with their geometry",
            value=f"up to {significant(float(np.abs(extensions).max()))} m",
            remedy="Check pins and directions of [kinematics.geometry], and the unit of the channels",
        )

    def as_small(self, extensions: Array) -> Array:
        """Extensions that the same motions would take if they were small [m], shape (p, n)."""
        return np.asarray(self.matrix @ self.displacements(extensions))

    def _extend(self, displacements: Array) -> tuple[Array, Array]:
        """Extensions, shape (p, n), and their slopes over the motions, shape (n, p, p)."""
        motion = dict(zip(self.motions, displacements, strict=True))
        still = np.zeros(displacements.shape[1])
        angle = motion.get("rotation", still)[:, np.newaxis, np.newaxis]
        normal_pins = self.pins @ _TURN.T
        pins = np.cos(angle) * self.pins + np.sin(angle) * normal_pins  # (n, p, 2)
        shift = np.stack([motion.get("x", still), motion.get("y", still)], axis=1)[:, np.newaxis]
        w = shift + pins - self.pins
        shortness = 1.0 / np.asarray(self.lengths)[:, np.newaxis]
        axis = self.directions + shortness * w
        ratio = np.linalg.norm(axis, axis=2, keepdims=True)
        longitudinal = (self.directions * w).sum(axis=2, keepdims=True)
        extension = (2.0 * longitudinal + shortness * (w**2).sum(axis=2, keepdims=True)) / (ratio + 1.0)
        unit = axis / ratio
        rates = {
            "x": unit[..., 0],
            "y": unit[..., 1],
            "rotation": (unit * (pins @ _TURN.T)).sum(axis=2),
        }
        slopes = np.stack([rates[motion] for motion in self.motions], axis=2)
        return np.ascontiguousarray(extension[..., 0].T), slopes
