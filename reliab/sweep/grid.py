"""Grids of actuators: which gains and delays are simulated for each structure."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import Dimension
from reliab.simulation.linear_loop.cells import Cells
from reliab.structures.structure import Structure
from reliab.tracking.boundary.contour import DELAY_SCALE, GAIN_SCALE, REACH, furthest_lead, stretch_coordinate

_FEWEST_GAINS, _FEWEST_DELAYS = 5, 4

Axis = tuple[tuple[str, ...], Array]
"""Names of dimensions and the values over them, as xarray takes a variable."""


class Grid(ABC):
    """Gains and delays that are simulated in all combinations."""

    name: ClassVar[str]

    @abstractmethod
    def gains(self, structure: Structure) -> Array:
        """Gains k_p [-] for a structure, increasing, shape (kp,)."""

    @abstractmethod
    def delays(self, structure: Structure) -> Array:
        """Delays τ [s] for a structure, increasing, 0 among them, negative for leads, shape (tau,)."""

    @property
    @abstractmethod
    def leads(self) -> bool:
        """Whether actuators that lead are among those simulated."""

    @abstractmethod
    def coordinates(self, frequencies: Sequence[float], damping_ratios: Sequence[float]) -> dict[str, Axis]:
        """Coordinates `kp` [-] and `tau` [s] of the dataset for all structures."""

    def cells(self, structure: Structure) -> Cells:
        """All combinations before a structure, the delay varying fastest."""
        gain, delay = np.meshgrid(self.gains(structure), self.delays(structure), indexing="ij")
        return Cells(structure=structure, gain=gain.ravel(), delay=delay.ravel())


@dataclass(frozen=True, kw_only=True)
class ExplicitGrid(Grid):
    """The same gains and delays for every structure, as in the paper.

    Raises InputError if there are too few values, or they do not increase.
    """

    name: ClassVar[str] = "explicit"

    # Gains [-], increasing, with 1 among them; by default 0.98 to 1.02 by 0.001
    gain: tuple[float, ...] = tuple(round(0.98 + 0.001 * k, 3) for k in range(41))
    # Delays [s], increasing, with 0 among them and negative for leads; by default 0 to 2 ms by 0.1 ms, as in
    # the paper
    delay: tuple[float, ...] = tuple(round(1e-4 * k, 4) for k in range(21))

    def __post_init__(self) -> None:
        for name, values, fewest in (
            ("gains", self.gain, _FEWEST_GAINS),
            ("delays", self.delay, _FEWEST_DELAYS),
        ):
            if len(values) < fewest or np.any(np.diff(values) <= 0.0):
                raise InputError(
                    f"An explicit grid needs at least {fewest} {name} that increase",
                    value=list(values),
                    remedy="Give them from the smallest to the largest",
                )
        if 0.0 not in self.delay or self.delay[-1] <= 0.0 or 1.0 not in self.gain:
            raise InputError(
                "The grid lacks the perfect actuator (gain 1, delay 0)",
                value=f"gains {self.gain[0]:g} … {self.gain[-1]:g}, "
                f"delays {self.delay[0]:g} … {self.delay[-1]:g} s",
                remedy="Add the gain 1, the delay 0 and delays above it",
            )

    @property
    def leads(self) -> bool:
        """Whether actuators that lead are among those simulated."""
        return self.delay[0] < 0.0

    def gains(self, structure: Structure) -> Array:  # noqa: ARG002 - the same for all
        """Gains k_p [-] for a structure, increasing, shape (kp,)."""
        return np.array(self.gain)

    def delays(self, structure: Structure) -> Array:  # noqa: ARG002 - the same for all
        """Delays τ [s] for a structure, increasing, shape (tau,)."""
        return np.array(self.delay)

    def coordinates(
        self,
        frequencies: Sequence[float],  # noqa: ARG002 - the same for all
        damping_ratios: Sequence[float],  # noqa: ARG002 - the same for all
    ) -> dict[str, Axis]:
        """Coordinates `kp` [-] and `tau` [s] of the dataset for all structures."""
        return {
            Dimension.GAIN: ((Dimension.GAIN,), np.array(self.gain)),
            Dimension.DELAY: ((Dimension.DELAY,), np.array(self.delay)),
        }


@dataclass(frozen=True, kw_only=True)
class ScaledGrid(Grid):
    """Gains that scale with ξ and delays that scale with ξ/ω₀, as the boundaries do.

    Around the perfect actuator the spacing is fine enough for the 1 % boundary of MTE^R; outwards it
    grows in proportion, in amplitude as far as contours are traced, and in delay up to four critical delays,
    where the 20 % boundary of RMS^R lies for the most tolerant motions. Leads go as far as a boundary is
    traced, or to a quarter of the shortest period.
    """

    name: ClassVar[str] = "scaled"

    _CORE: ClassVar[float] = 0.015  # of ξ, or of ξ/ω₀: below it the spacing is even
    _LONGEST: ClassVar[float] = 7.0  # of ξ/ω₀; the critical delay is about 2

    gain_steps: int = 20  # Gains on each side of 1
    delay_steps: int = 30  # Delays above zero
    lead_steps: int = 26  # Leads; 0 leaves them out

    def __post_init__(self) -> None:
        if self.lead_steps != 0 and self.lead_steps < _FEWEST_DELAYS:
            raise InputError(
                f"A scaled grid needs at least {_FEWEST_DELAYS} leads, or none",
                value=self.lead_steps,
                remedy="Ask for more steps",
            )
        if self.gain_steps < _FEWEST_GAINS or self.delay_steps < _FEWEST_DELAYS:
            raise InputError(
                f"A scaled grid needs at least {_FEWEST_GAINS} steps of gain and {_FEWEST_DELAYS} of delay",
                value=f"{self.gain_steps} and {self.delay_steps}",
                remedy="Ask for more steps",
            )

    def gains(self, structure: Structure) -> Array:
        """Gains k_p [-] for a structure, increasing, shape (kp,)."""
        return self._gains(structure.damping_ratio)

    def delays(self, structure: Structure) -> Array:
        """Delays τ [s] for a structure, increasing, negative for leads, shape (tau,)."""
        return self._delays(structure.frequency, structure.damping_ratio)

    @property
    def leads(self) -> bool:
        """Whether actuators that lead are among those simulated."""
        return self.lead_steps > 0

    def coordinates(self, frequencies: Sequence[float], damping_ratios: Sequence[float]) -> dict[str, Axis]:
        """Coordinates `kp` [-] over (xi, kp) and `tau` [s] over (f, xi, tau)."""
        gain = np.stack([self._gains(xi) for xi in damping_ratios])
        delay = np.stack([[self._delays(f, xi) for xi in damping_ratios] for f in frequencies])
        return {
            Dimension.GAIN: ((Dimension.DAMPING_RATIO, Dimension.GAIN), gain),
            Dimension.DELAY: ((Dimension.FREQUENCY, Dimension.DAMPING_RATIO, Dimension.DELAY), delay),
        }

    def _gains(self, damping_ratio: float) -> Array:
        outwards = _space_evenly(self._CORE, GAIN_SCALE * REACH, REACH, self.gain_steps)
        return np.exp(damping_ratio * np.concatenate([-outwards[:0:-1], outwards]))

    def _delays(self, frequency: float, damping_ratio: float) -> Array:
        scale = damping_ratio / (2.0 * np.pi * frequency)
        late = _space_evenly(self._CORE, DELAY_SCALE * self._LONGEST, self._LONGEST, self.delay_steps)
        if self.lead_steps == 0:
            return scale * late
        # The loop without numerical stiffness has the shortest period of all experimental fractions.
        structure = Structure(frequency=frequency, damping_ratio=damping_ratio)
        highest_gain = np.exp(REACH * damping_ratio)
        furthest = float(furthest_lead(structure, np.array(highest_gain))) / scale
        early = _space_evenly(self._CORE, DELAY_SCALE * self._LONGEST, furthest, self.lead_steps)
        return scale * np.concatenate([-early[:0:-1], late])


@lru_cache(maxsize=64)
def _space_evenly(core: float, scale: float, furthest: float, steps: int) -> Array:
    """Values from zero, evenly spaced in the coordinate in which surfaces are interpolated."""
    dense = np.concatenate([[0.0], np.geomspace(1e-3 * core, furthest, 20_000)])
    even = np.linspace(0.0, float(stretch_coordinate(np.array(furthest), core, scale)), steps + 1)
    return np.asarray(np.interp(even, stretch_coordinate(dense, core, scale), dense), dtype=np.float64)
