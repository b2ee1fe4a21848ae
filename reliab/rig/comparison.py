"""Two rigs, or one before and after a change, and whether it became better."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.rig.memory import Memory
from reliab.rig.rig_table import RigTable

_DRAWS: Final = 2000


@dataclass(frozen=True, kw_only=True)
class Contrast:
    """One quantity of both; smaller is better."""

    before: float
    after: float
    probability_better: float  # That its median over tests of many earthquakes is smaller
    next_test_better: float  # That a test of the second has a smaller one than a test of the first


@dataclass(frozen=True, kw_only=True, eq=False)
class RigComparison:
    """Two rigs compared."""

    tests: tuple[int, int]
    contrasts: Mapping[str, Contrast]

    @property
    def probability_better(self) -> float:
        """Probability that the error became smaller."""
        return self.contrasts["rms"].probability_better

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "tests": list(self.tests),
            "probability_better": self.probability_better,
            **{name: vars(contrast) for name, contrast in self.contrasts.items()},
        }


def compare_tables(first: RigTable, second: RigTable) -> RigComparison:
    """Compare by medians over earthquakes that are drawn with replacement.

    Errors are those over the usual test's by the ellipse of each structure, so that structures may differ.
    """
    memories = Memory.remembered(first), Memory.remembered(second)
    first_memory = memories[0]
    usual = float(np.median(first_memory.log_scales()))
    values = [
        {
            "amplitude_error": np.abs(memory.amplitude - 1.0),
            "delay_ms": np.abs(memory.delay),
            "remainder": np.exp(memory.log_remainder),
            "rms": np.exp(memory.log_error - first_memory.log_scales(memory.table) + usual),
        }
        for memory in memories
    ]
    rng = np.random.default_rng(0)
    drawn = [_drawn_tests(memory.events, rng) for memory in memories]
    contrasts = {}
    for name in values[0]:
        one_rig, another = (value[name] for value in values)
        medians = [
            np.array([np.median(value[places]) for places in sets])
            for value, sets in zip((one_rig, another), drawn, strict=True)
        ]
        contrasts[name] = Contrast(
            before=float(np.median(one_rig)),
            after=float(np.median(another)),
            probability_better=_share_smaller(medians[1], medians[0]),
            next_test_better=_share_smaller(another[:, None], one_rig),
        )
    return RigComparison(tests=(len(memories[0].table), len(memories[1].table)), contrasts=contrasts)


def _drawn_tests(events: NDArray[np.str_], rng: np.random.Generator) -> list[NDArray[np.intp]]:
    """Places of the tests of as many earthquakes as there are, drawn with replacement again and again."""
    groups = [np.flatnonzero(events == event) for event in np.unique(events)]
    return [
        np.concatenate([groups[place] for place in rng.integers(len(groups), size=len(groups))])
        for _ in range(_DRAWS)
    ]


def _share_smaller(after: Array, before: Array) -> float:
    """Share of pairs in which the first is smaller; ties count half."""
    return float(((after < before) + 0.5 * (after == before)).mean())
