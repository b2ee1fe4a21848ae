"""Rates over judged tests, family by family."""

from typing import Final

import numpy as np
import pandas as pd

ALL: Final = "all"
"""Name of the row over all families."""

_NEAR, _WIDE = 0.10, 0.25


def summarise(tests: pd.DataFrame, threshold: float) -> pd.DataFrame:
    """Rates of judged tests, one row a family and one over all.

    `tests` as `judge_tests` gives them; `threshold` of a good test [-]. Columns: tests, near and wide (share
    whose value lies within 10 and 25 % of the true error), held (share of intervals that hold it), bad
    (number of bad tests), false_safe (accepted bad tests over all tests), accepted (of the good ones),
    refused_good (of the good ones), undecided, left (median) and inside (mean) [-]; tests that were refused
    count as undecided and as missed.
    """
    groups = [(name, rows) for name, rows in tests.groupby("family", sort=False)]
    return pd.DataFrame([_rates(str(name), rows, threshold) for name, rows in [*groups, (ALL, tests)]])


def _rates(name: str, tests: pd.DataFrame, threshold: float) -> dict[str, object]:
    away = (tests["value"] / tests["true"] - 1.0).abs()
    good = tests["true"] <= threshold
    said_good, said_bad = tests["word"] == "reliable", tests["word"] == "not_reliable"
    return {
        "family": name,
        "tests": len(tests),
        "near": (away < _NEAR).mean(),
        "wide": (away < _WIDE).mean(),
        "held": ((tests["low"] <= tests["true"]) & (tests["true"] <= tests["high"])).mean(),
        "bad": int((~good).sum()),
        "false_safe": (said_good & ~good).mean(),
        "accepted": _share(said_good[good]),
        "refused_good": _share(said_bad[good]),
        "undecided": (~said_good & ~said_bad).mean(),
        "left": tests["left"].median(),
        "inside": tests["inside"].mean(),
    }


def _share(words: pd.Series) -> float:
    return float(words.mean()) if len(words) else np.nan


def compare_with_stated(tests: pd.DataFrame) -> dict[str, float]:
    """Say what tests of linear specimens lose when nobody states that they are.

    Returns the number of tests, `agree` (share of equal verdicts), `opposed` (share of opposite ones), and
    `width` and `widest`, the median and the 95th percentile of the ratio of the intervals' widths; empty
    where no test of a linear specimen was judged as it is stated.
    """
    if "stated_word" not in tests:
        return {}
    linear = tests.dropna(subset=["stated_word"])
    width = (linear["high"] - linear["low"]) / (linear["stated_high"] - linear["stated_low"])
    words = set(zip(linear["word"], linear["stated_word"], strict=True))
    opposite = {("reliable", "not_reliable"), ("not_reliable", "reliable")}
    pairs = pd.Series(list(zip(linear["word"], linear["stated_word"], strict=True)), dtype=object)
    return {
        "tests": float(len(linear)),
        "agree": float((linear["word"] == linear["stated_word"]).mean()),
        "opposed": float(pairs.isin(opposite & words).mean()),
        "width": float(width.median()),
        "widest": float(width.quantile(0.95)),
    }
