"""The modes of a structure whose energy is watched while a test runs.

In a mode that moves the interface by ν (its modal mass one), errors x_m − x_c work as the modal force
νᵀK_e(x_m − x_c), and a motion of that mode alone has the coordinate νᵀK_e x_c/(νᵀK_e ν). To first order a
delay of 2ξω/(νᵀK_e ν) uses the damping of the mode up: the modes with the shortest of these are watched.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg

from reliab.arrays import Array
from reliab.structures import Partition

MEMORY = 3.0
"""Periods of a mode after which its window has forgotten all but 1/e."""

LOOKS = 4
"""Looks at the net damping of a mode in its period."""

WIDTH = 2.0  # quality factor of the band in which a mode is watched
_MODES_FOR_EACH_ACTUATOR = 3
_TAKES_PART = 1e-6  # of the largest share of the specimen in a mode: a mode with less cannot become unstable
_ROUNDING = 1e-24  # of the mode's own stiffness squared, that rounding leaves of no exchange
_FEWEST_SAMPLES = 5.0  # in a period of a mode: fewer do not show its motion


@dataclass(frozen=True, kw_only=True, eq=False)
class Modes:
    """All modes of a structure, and the stiffness by which the specimen couples them, shape (n, n)."""

    circular_frequencies: Array  # [rad/s], ascending, shape (n,)
    ratios: Array  # ξ [-], shape (n,)
    coupling: Array  # νᵢᵀK_eνⱼ of modes with a modal mass of one [1/s²]
    loads: Array  # K_eν, shape (p, n)


@dataclass(frozen=True, kw_only=True, eq=False)
class WatchedMode:
    """A mode whose energy is watched, and how the specimen couples it with the others."""

    modes: Modes
    place: int  # Of the mode among all modes
    time_step: float  # [s]

    @property
    def projection(self) -> Array:
        """By which interface displacements are carried to the mode [-], shape (p,)."""
        stiffness = self.stiffness
        loads = self.modes.loads[:, self.place]
        return loads / stiffness if stiffness > 0.0 else np.zeros(loads.size)

    @cached_property
    def circular_frequency(self) -> float:
        """ω [rad/s]."""
        return float(self.modes.circular_frequencies[self.place])

    @cached_property
    def ratio(self) -> float:
        """ξ [-]."""
        return float(self.modes.ratios[self.place])

    @cached_property
    def stiffness(self) -> float:
        """νᵀK_eν, for one degree of freedom αω₀² [1/s²]."""
        return float(self.modes.coupling[self.place, self.place])

    @cached_property
    def exchange(self) -> Array:
        """νᵀK_eνⱼ · νⱼᵀK_eν, by which an error moves mode j and this one by it, shape (n,) [1/s⁴].

        Zero where only rounding couples them, as modes of one frequency in a symmetric structure.
        """
        exchange = self.modes.coupling[self.place] * self.modes.coupling[:, self.place]
        return np.where(np.abs(exchange) > _ROUNDING * self.stiffness**2, exchange, 0.0)

    @cached_property
    def samples(self) -> float:
        """Samples in a period [-]."""
        return 2.0 * np.pi / (self.circular_frequency * self.time_step)

    @cached_property
    def forgetting(self) -> float:
        """Weight that is left of the past after a step [-]."""
        return float(np.exp(-1.0 / (MEMORY * self.samples)))

    @property
    def look(self) -> int:
        """Samples from one look to the next."""
        return max(round(self.samples / LOOKS), 1)

    @property
    def band(self) -> Array:
        """Coefficients b₀, a₁ and a₂ of the band-pass y = b₀(x − x₋₂) − a₁y₋₁ − a₂y₋₂, shape (3,)."""
        tangent = np.tan(0.5 * self.circular_frequency * self.time_step)
        whole = 1.0 + tangent / WIDTH + tangent**2
        last = 1.0 - tangent / WIDTH + tangent**2
        return np.asarray(np.array([tangent / WIDTH, 2.0 * (tangent**2 - 1.0), last]) / whole)


def watched_modes(structure: Partition, time_step: float) -> tuple[WatchedMode, ...]:
    """Return the modes to watch, the one with the shortest critical delay first; `time_step` [s]."""
    interface, specimen = structure.interface, structure.specimen_stiffness
    squares, shapes = scipy.linalg.eigh(structure.stiffness, structure.mass)
    omega = np.sqrt(np.maximum(squares, np.finfo(float).tiny))
    moved = interface.T @ shapes
    modes = Modes(
        circular_frequencies=omega,
        ratios=np.einsum("di,de,ei->i", shapes, structure.damping, shapes) / (2.0 * omega),
        coupling=moved.T @ specimen @ moved,
        loads=specimen @ moved,
    )
    own = np.diag(modes.coupling)
    shares = own / omega**2
    takes_part = (shares > _TAKES_PART * shares.max()) & (omega * time_step * _FEWEST_SAMPLES < 2.0 * np.pi)
    delays = np.full(omega.size, np.inf)
    delays[takes_part] = 2.0 * modes.ratios[takes_part] * omega[takes_part] / own[takes_part]
    count = min(_MODES_FOR_EACH_ACTUATOR * interface.shape[1], max(int(takes_part.sum()), 1))
    places = np.argsort(delays, kind="stable")[:count]
    return tuple(WatchedMode(modes=modes, place=int(place), time_step=time_step) for place in places)
