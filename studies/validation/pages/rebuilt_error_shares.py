"""The rebuilt error beside criteria: what errors they state, and which tests they accept."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reliab.report import (
    GREY,
    INK,
    label_logarithmic,
    legend_below,
    letters,
    line,
    name_axes,
    panels,
    plain,
    styled,
)
from reliab.vocabulary import PERCENT

_HEIGHT = 92.0
_ROW = 11.0
_SHARES_HEIGHT = 40.0
_SHIFT = 0.16


@styled
def stated_errors(tests: pd.DataFrame, judges: tuple[str, ...]) -> Figure:
    """Draw the error that judges state over the true one.

    `tests`: columns judge, rig, error [-] and estimate [-], one row for each test and judge. Result: errors
    [%] on logarithmic scales, by actuator; on the diagonal they agree.
    """
    figure, axes = panels(1, len(judges), height=_HEIGHT, share_x=True, share_y=True)
    estimated = tests[
        tests["judge"].isin(judges) & np.isfinite(tests["estimate"]) & (tests["estimate"] > 0.0)
    ]
    percent = PERCENT * estimated[["error", "estimate"]]
    ends = (0.8 * float(percent.min().min()), 1.25 * float(percent.max().max()))
    for place, judge in zip(axes[0], judges, strict=True):
        place.plot(ends, ends, color=GREY, linewidth=0.9)
        of_judge = estimated[estimated["judge"] == judge]
        for rank, (name, rows) in enumerate(of_judge.groupby("rig", sort=False)):
            look = {**line(rank, marker=True), "linestyle": "none", "fillstyle": "none"}
            place.plot(PERCENT * rows["error"], PERCENT * rows["estimate"], label=plain(str(name)), **look)
        place.set(xscale="log", yscale="log", xlim=ends, ylim=ends, aspect="equal")
        label_logarithmic(place.xaxis, place.yaxis)
        name_axes(place, "True error of the test [%]", "Stated error [%]" if place is axes[0, 0] else "")
    letters(axes, tuple(judges))
    legend_below(figure, axes[0, 0], columns=3)
    return figure


@styled
def accepted_tests(rows: pd.DataFrame) -> Figure:
    """Draw which share of bad and of good tests each judge accepts.

    `rows`: columns judge, and bad_accepted and good_accepted [-], each with _low and _high. Result: shares
    [%] with their 95 % intervals, a row for each judge.
    """
    figure, axes = panels(height=_SHARES_HEIGHT + _ROW * len(rows))
    place = axes[0, 0]
    middle = np.arange(len(rows), dtype=float)
    for rank, (name, label) in enumerate(
        (("bad_accepted", "bad tests accepted"), ("good_accepted", "good tests accepted"))
    ):
        share = PERCENT * rows[name].to_numpy(float)
        ends = [PERCENT * rows[f"{name}_{end}"].to_numpy(float) for end in ("low", "high")]
        reach = np.nan_to_num(np.maximum(np.stack([share - ends[0], ends[1] - share]), 0.0))
        look = {**line(rank, marker=True), "linestyle": "none"}
        place.errorbar(share, middle + (2 * rank - 1) * _SHIFT, xerr=reach, label=label, capsize=2.0, **look)
    place.axvline(0.0, color=INK, linewidth=0.5)
    place.set(xlim=(-3.0, 103.0), ylim=(len(rows) - 0.5, -0.5))
    place.set_yticks(middle, [plain(str(name)) for name in rows["judge"]])
    name_axes(place, "Share of the tests [%]", "")
    legend_below(figure, place, columns=2)
    return figure
