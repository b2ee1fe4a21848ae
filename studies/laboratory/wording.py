"""How reports of benchmarks say which compensator keeps which tests good."""

import pandas as pd


def count_good_tests(good: pd.Series) -> str:
    """Say how many tests of each compensator are good, the best first.

    `good`: whether a test is good, shape (tests,), by the compensator's name.

    >>> names = ["none", "none", "inverse", "inverse", "adaptive", "adaptive"]
    >>> count_good_tests(pd.Series([True, False, True, True, True, True], index=names))
    'in all 2 tests (inverse, adaptive), in 1 of 2 (none)'
    >>> count_good_tests(pd.Series([False, False], index=["none", "none"]))
    'in 0 of 2 tests (none)'
    """
    counts = good.groupby(level=0, sort=False).agg(["sum", "size"]).astype(int)
    counts["share"] = counts["sum"] / counts["size"]
    pieces = []
    for (_, count, size), of_names in counts.groupby(["share", "sum", "size"], sort=True):
        share = f"all {size}" if count == size else f"{count} of {size}"
        pieces.append((share, ", ".join(map(str, of_names.index))))
    pieces.reverse()
    first, *others = pieces
    return ", ".join(
        [f"in {first[0]} tests ({first[1]})", *(f"in {share} ({names})" for share, names in others)]
    )
