"""Simulate tests and have each of them judged, motion by motion."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd

from reliab.core.errors import InputError
from reliab.core.plain_values import read_table, write_table
from reliab.core.progress import Progress, silent
from reliab.validation.counts import event_bootstrap

from .bench import tests_of_round
from .design import Design
from .judges import OWN_BOUNDARY, REBUILT
from .rigs import LINEAR, PLAIN, RIGHT

STUDY_COLUMNS: Final = (
    *("study", "round", "motion", "event", "test", "rig", "specimen", "f", "xi", "alpha", "sensor", "stated"),
    *("error", "good", "judge", "accepted", "estimate", "low", "high", "looks_nonlinear"),
)
"""Columns of a study: a row for each judge of each test under each condition."""


def try_tests(design: Design, *, kept: Path | None = None, progress: Progress = silent) -> pd.DataFrame:
    """Simulate tests and let every judge judge them.

    Returns [-].
    Returns columns :data:`STUDY_COLUMNS`: the true `error` [-] of the test and whether it is `good`; of the
    `judge` whether it `accepted` the test, and the error that it stated, `estimate` with its 90 % interval
    `low` to `high` [-], where it states one; and whether the specimen `looks_nonlinear`, where the recorded
    force was looked at (1 or 0). Tests that run away are not judged, since nobody takes them for good.
    """
    table = _read_kept(kept, design.digest)
    table = table[table["round"] < design.trials]
    done = set(table["round"].tolist())
    for number in range(design.trials):
        if number not in done:
            rows = pd.DataFrame(list(tests_of_round(design, number)), columns=list(STUDY_COLUMNS))
            table = rows if table.empty else pd.concat([table, rows], ignore_index=True)
            if kept is not None:
                write_table(table, kept)
        progress(number + 1, design.trials)
    return table


def _read_kept(path: Path | None, digest: str) -> pd.DataFrame:
    if path is None or not path.exists():
        return pd.DataFrame(columns=list(STUDY_COLUMNS))
    try:
        table = read_table(path)
    except (OSError, ValueError) as error:
        raise InputError(
            "The file of a study must be a table that an earlier run wrote",
            value=str(error),
            remedy="Name another file",
            where=str(path),
        ) from error
    if list(table.columns) != list(STUDY_COLUMNS) or not (table["study"] == digest).all():
        raise InputError(
            "An interrupted study can only be resumed with its own file",
            value="other motions, structures, errors, or another version",
            remedy="Name another file",
            where=str(path),
        )
    return table


_ENDS = (0.05, 0.95)


def shares(tests: pd.DataFrame, by: Sequence[str]) -> pd.DataFrame:
    """Count the tests that each method accepted.

    Returns one row a group, in the order of the tests: `tests`, `motions`; `bad` tests and the share
    `bad_accepted` of them, `good` tests and the share `good_accepted` of them, each with `_low` and `_high`
    ends of its 95 % interval over earthquakes; `contained`, the share of motions of which no bad test is
    accepted; quantiles `ratio_05`, `ratio_50`, `ratio_95` of the stated over the true error, and `covered`,
    the share of true errors inside the stated 90 % interval. NaN where there is nothing to count.

    >>> tests = pd.DataFrame(
    ...     {
    ...         "motion": ["a", "a", "b", "b"],
    ...         "event": ["a", "a", "b", "b"],
    ...         "judge": "one",
    ...         "error": [0.02, 0.08, 0.02, 0.08],
    ...         "good": [True, False, True, False],
    ...         "accepted": [True, True, True, False],
    ...         "estimate": [0.02, 0.04, 0.02, 0.08],
    ...         "low": 0.0,
    ...         "high": 0.06,
    ...     }
    ... )
    >>> row = shares(tests, ["judge"]).iloc[0]
    >>> [float(row[name]) for name in ("good_accepted", "bad_accepted", "contained", "covered")]
    [1.0, 0.5, 0.5, 0.5]
    """
    rows = []
    for names, group in tests.groupby(list(by), sort=False):
        rows.append({**dict(zip(by, names, strict=True)), **_count_tests(group)})
    return pd.DataFrame(rows)


def summarise_study(tests: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Summarise a study in the tables that are printed and reported.

    Returns [-].
    Returns each as :func:`shares` makes it: "judges" on linear specimens with a sensor of 40 dB and all
    stated rightly; "rigs", the same by actuator for the rebuilt error and the motion's own boundary;
    "conditions", every judge by sensor and by what is stated wrongly; "specimens", every judge by nonlinear
    specimen; and "looks", by specimen and sensor the share of tests whose recorded force `looks_nonlinear`
    [-] among so many `tests`.
    """
    linear = tests[tests["specimen"] == LINEAR]
    plain = linear[(linear["sensor"] == PLAIN.sensor) & (linear["stated"] == RIGHT)]
    looked = tests[(tests["judge"] == REBUILT) & tests["looks_nonlinear"].notna()]
    looks = looked.groupby(["specimen", "sensor"], sort=False)["looks_nonlinear"].agg(["mean", "count"])
    return {
        "judges": shares(plain, ["judge"]),
        "rigs": shares(plain[plain["judge"].isin([REBUILT, OWN_BOUNDARY])], ["judge", "rig"]),
        "conditions": shares(linear, ["sensor", "stated", "judge"]),
        "specimens": shares(tests[tests["specimen"] != LINEAR], ["specimen", "judge"]),
        "looks": looks.reset_index().rename(columns={"mean": "looks_nonlinear", "count": "tests"}),
    }


def _count_tests(group: pd.DataFrame) -> dict[str, Any]:
    good, accepted = group["good"].to_numpy(bool), group["accepted"].to_numpy(bool)
    ratio = (group["estimate"] / group["error"]).to_numpy(float)
    known, bounded = np.isfinite(ratio), np.isfinite(group["high"].to_numpy(float))
    inside = (group["low"] <= group["error"]) & (group["error"] <= group["high"])
    low, middle, high = np.quantile(ratio[known], [_ENDS[0], 0.5, _ENDS[1]]) if known.any() else [np.nan] * 3
    unsafe = pd.Series(accepted & ~good).groupby(group["motion"].to_numpy()).any()
    return {
        "tests": len(group),
        "motions": len(unsafe),
        "bad": int((~good).sum()),
        **_rate("bad_accepted", accepted & ~good, ~good, group["event"]),
        "good": int(good.sum()),
        **_rate("good_accepted", accepted & good, good, group["event"]),
        "contained": float(1.0 - unsafe.mean()),
        "ratio_05": float(low),
        "ratio_50": float(middle),
        "ratio_95": float(high),
        "covered": float(inside.to_numpy()[bounded].mean()) if bounded.any() else np.nan,
    }


def _rate(name: str, counted: np.ndarray, among: np.ndarray, events: pd.Series) -> dict[str, float]:
    total = int(among.sum())
    rate = float(counted.sum() / total) if total else np.nan
    low, high = (
        float(end)
        for end in event_bootstrap(counted.astype(float), among.astype(float), events.to_numpy(str))
    )
    return {name: rate, f"{name}_low": low, f"{name}_high": high}
