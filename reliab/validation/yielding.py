"""What a criterion for linear structures is worth once the specimen yields, as measured on tests that do."""

from dataclasses import dataclass
from typing import Final

import pandas as pd

from reliab.core.shipped import shipped

HARDENING: Final = 0.02
"""Stiffness after yielding over the elastic one [-]."""

_TABLE = "yielding/yielding.csv"


@dataclass(frozen=True, kw_only=True)
class Yielding:
    """What was measured on yielding specimens, over all structures."""

    reduction: float  # R [-]
    tests: int  # tests, motions: How many were simulated, under how many ground motions
    motions: int
    exceeding: float  # Share of the tests whose error exceeds the one of the linear boundary [-]
    largest_ratio: float  # Largest error over the one of the linear boundary [-]


def read_yielding() -> tuple[Yielding, ...]:
    """Read the results that ship, one for each R."""
    table = pd.read_csv(shipped("datasets", _TABLE))
    return tuple(
        Yielding(
            reduction=float(row["R"]),
            tests=int(row["tests"]),
            motions=int(row["motions"]),
            exceeding=float(row["exceeding"]),
            largest_ratio=float(row["largest_ratio"]),
        )
        for row in table[table["f"].isna()].sort_values("R").to_dict(orient="records")
    )
