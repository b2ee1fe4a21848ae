"""Natural frequencies of structures of which single entries of a matrix are uncertain.

An entry that is a few per cent off moves the lowest frequency as far as a whole stiffness does, and near
resonance the error is largest with the frequency that the test really had. A test shows its frequency, and
with it which of the drawn entries its structure had.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.sobol import normal_points
from reliab.structures import Partition, is_of_entries

_DRAWS = 64


@dataclass(frozen=True, kw_only=True, eq=False)
class EntriesOfStructure:
    """Uncertain entries of M and K, with the structure they belong to."""

    structure: Partition  # As stated
    deviations: Mapping[str, float]  # Of the entries by name, relative [-]

    @classmethod
    def of_parts(cls, structure: Partition, deviations: Mapping[str, float]) -> "EntriesOfStructure | None":
        """Collect those that move frequencies; None where there are none."""
        moving = {
            name: deviation
            for name, deviation in deviations.items()
            if is_of_entries(name) and not name.startswith("damping") and deviation
        }
        return cls(structure=structure, deviations=moving) if moving else None

    @cached_property
    def deviation(self) -> float:
        """Standard deviation of the lowest frequency that they leave open, relative [-]."""
        points = normal_points(len(self.deviations), _DRAWS, seed=0)
        drawn = {name: row * self.deviations[name] for name, row in zip(self.deviations, points, strict=True)}
        return float(np.std(self._factors(drawn)))

    def matched(self, drawn: Mapping[str, Array]) -> dict[str, Array]:
        """Give each draw the entries whose lowest frequency is nearest to its own.

        `drawn`: quantities by name, shape (draws,), with "frequency", of which what no entries explain
        remains.
        """
        factors = self._factors(drawn)
        order = np.argsort(factors)
        sought = 1.0 + drawn["frequency"]
        middles = 0.5 * (factors[order][1:] + factors[order][:-1])
        places = order[np.searchsorted(middles, sought)]
        of_entries = {name: drawn[name][places] for name in self.deviations}
        return {**drawn, **of_entries, "frequency": sought / factors[places] - 1.0}

    def _factors(self, drawn: Mapping[str, Array]) -> Array:
        """Lowest natural frequency of each draw, over the stated one [-], shape (draws,)."""
        draws = zip(*(drawn[name].tolist() for name in self.deviations), strict=True)
        changed = (self.structure.with_parts(dict(zip(self.deviations, one, strict=True))) for one in draws)
        lowest = np.array([structure.natural_frequencies[0] for structure in changed])
        return np.asarray(lowest / self.structure.natural_frequencies[0])
