"""Summary of many tests with nonlinear specimens."""

from typing import Any, Final

import numpy as np
import pandas as pd

from reliab.validation.cross_validation import event_bootstrap

from .tolerances import DIRECTIONS

NARROWEST: Final = "narrowest"
"""The direction in which a test's tolerance has shrunk most, or grown least."""

QUANTILES: Final = {"q05": 0.05, "q25": 0.25, "q50": 0.5, "q75": 0.75, "q95": 0.95}
"""Columns of quantiles over tests."""

FEWEST_MOTIONS: Final = 20
"""Motions from which a limit that 95 % of them keep is stated."""

_CONFIDENCE = 0.95


def compare_levels(tests: pd.DataFrame) -> pd.DataFrame:
    """Quantiles of the tolerances over those of linear tests, for each specimen and direction.

    One row for each specimen, level, structure (`f` and `xi` NaN for all of them together) and direction, the
    narrowest one of a test included: `tests` counted, `lost` ones whose exact response runs away, `motions`,
    `events`, median `ductility` [-], quantiles `q05` … `q95` of the tolerance over that of the linear test
    [-], and `narrower`, the share of tests that tolerate less than the linear one, with `low` and `high` ends
    of its 95 % interval over earthquakes.
    """
    tests = tests.assign(**{NARROWEST: tests[list(DIRECTIONS)].min(axis=1, skipna=False)})
    rows = []
    everything = tests.assign(f=np.nan, xi=np.nan)
    for (kind, level, f, xi), group in [
        *everything.groupby(["specimen", "level", "f", "xi"], sort=False, dropna=False),
        *tests.groupby(["specimen", "level", "f", "xi"], sort=False),
    ]:
        about = {"specimen": kind, "level": level, "f": f, "xi": xi}
        rows += [about | _row(group, direction) for direction in (*DIRECTIONS, NARROWEST)]
    return pd.DataFrame(rows)


def _row(group: pd.DataFrame, direction: str) -> dict[str, Any]:
    """Statistics of one specimen in one direction."""
    sound = group[group[direction].notna()]
    below = np.asarray(sound[direction] < 1.0, dtype=np.float64)
    low, high = event_bootstrap(below, np.ones(below.size), sound["event"].to_numpy(dtype=np.str_))
    return {
        "direction": direction,
        "tests": len(sound),
        "lost": len(group) - len(sound),
        "motions": sound["motion"].nunique(),
        "events": sound["event"].nunique(),
        "ductility": sound["ductility"].median(),
        **{name: sound[direction].quantile(share) for name, share in QUANTILES.items()},
        "narrower": below.mean() if below.size else np.nan,
        "low": float(low),
        "high": float(high),
    }


def compare_limits(tests: pd.DataFrame) -> pd.DataFrame:
    """Compare what 95 % of the motions tolerate with nonlinear and with linear specimens.

    One row for each specimen, level and structure: the delay alone [ms] and the amplitude error alone [-],
    the smaller one of both signs, that 95 % of the motions tolerate: `delay_ms`, `amplitude`, and
    `linear_delay_ms`, `linear_amplitude` of the linear structure. NaN for fewer than `FEWEST_MOTIONS`
    motions.
    """
    tests = tests.assign(
        delay_ms=tests["linear_delay_ms"] * tests["late"],
        amplitude=np.minimum(tests["linear_large"] * tests["large"], tests["linear_small"] * tests["small"]),
        linear_amplitude=tests[["linear_large", "linear_small"]].min(axis=1),
    )
    names = ["delay_ms", "linear_delay_ms", "amplitude", "linear_amplitude"]
    rows = []
    for keys, group in tests.groupby(["specimen", "level", "f", "xi"], sort=False):
        about = dict(zip(("specimen", "level", "f", "xi"), keys, strict=True))
        enough = group["motion"].nunique() >= FEWEST_MOTIONS
        # A test whose exact response runs away tolerates nothing.
        limits = group[names].fillna(0.0).quantile(1.0 - _CONFIDENCE)
        rows.append(about | {name: limits[name] if enough else np.nan for name in names})
    return pd.DataFrame(rows)
