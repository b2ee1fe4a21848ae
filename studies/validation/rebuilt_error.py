"""Section on the rebuilt error compared with criteria, on the same simulated tests."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reliab.core.significant_digits import counted, percent
from reliab.core.vocabulary import PERCENT
from reliab.report.document import Column, Figure as RpFigure, Section, Table
from reliab.report.numbers import Fixed
from reliab.report.prose import Prose, prose
from reliab.report.style import (
    GREY,
    INK,
    apply_style,
    label_logarithmic,
    legend_below,
    letters,
    line,
    name_axes,
    panels,
    plain as rp_plain,
)

from .rebuilt_error_study.judges import OWN_BOUNDARY, REBUILT, WITH_MODEL
from .rebuilt_error_study.rigs import LINEAR, PLAIN, RIGHT
from .rebuilt_error_study.study import summarise_study

_NAMES = {"guo_2017_15": "equation (15)", "guo_2017_18": "equation (18)"}


def rebuilt_error_section(tests: pd.DataFrame, threshold: float) -> Section:
    """Report what the rebuilt error is worth beside criteria.

    `threshold`: error up to which a test is good [-].
    """
    by_judge = tests.assign(judge=tests["judge"].replace(_NAMES))
    tables = summarise_study(by_judge)
    return Section(
        title="The error of the test itself",
        blocks=(
            _opening(tables["looks"], threshold),
            _population(by_judge),
            *_figures(by_judge, tables["judges"]),
            *_tables(tables),
        ),
        label="sec:rebuilt",
    )


def _opening(looks: pd.DataFrame, threshold: float) -> Prose:
    """Say how tests were judged, and how often specimens look nonlinear."""
    nonlinear = looks.set_index("specimen")["looks_nonlinear"].drop(LINEAR)
    linear = looks.set_index(["specimen", "sensor"])["looks_nonlinear"][LINEAR, PLAIN.sensor]
    return prose(
        "The same simulated tests, judged by the error that is rebuilt from command and measured "
        "displacement, and by $A$ and $d$ with criteria and with the boundary of the test's own "
        "motion. A test is good up to {threshold} of true error, which is that of the true piston "
        "against the same loop with a perfect actuator. A criterion without limits for leads accepts "
        "no test that leads. A verdict is “reliable” as reliab assess gives it: the error stays "
        "below the threshold with 95 % probability, and the specimen does not look nonlinear. A motion "
        "is contained when none of its bad tests is accepted, and an error in the interval when the "
        "stated 90 % interval holds it. The rebuilt error takes the structure as linear and stated; "
        "nonlinear specimens are recognised in {nonlinear} of their tests, and linear "
        "ones are taken for nonlinear in {linear} of their tests, at 40 dB.",
        threshold=percent(threshold),
        nonlinear=percent(float(nonlinear.mean())) if len(nonlinear) else "none",
        linear=percent(float(linear)),
    )


def _population(tests: pd.DataFrame) -> Prose:
    """Say of which tests the numbers on linear specimens are."""
    accepted = tests[
        (tests["specimen"] == LINEAR)
        & (tests["sensor"] == PLAIN.sensor)
        & (tests["stated"] == RIGHT)
        & (tests["judge"] == REBUILT)
    ]
    structures = accepted[["f", "xi", "alpha"]].drop_duplicates()
    return prose(
        "The numbers on linear specimens are those of {n}: {rigs} under {motions}, "
        "on {structures}, with true errors of {least} to {most}. They hold for tests like "
        "these: larger errors give narrower ratios of stated to true error. Those of another series, in "
        "a laboratory of its own, stand in datasets/rebuilt_error.",
        n=counted(len(accepted), "test"),
        rigs=counted(accepted["rig"].nunique(), "actuator"),
        motions=counted(accepted["motion"].nunique(), "motion"),
        structures=", ".join(
            f"a structure of {f:g} Hz and {percent(xi)} damping (α = {alpha:g})"
            for f, xi, alpha in structures.itertuples(index=False)
        ),
        least=percent(float(accepted["error"].min()), 2),
        most=percent(float(accepted["error"].max()), 2),
    )


def _figures(tests: pd.DataFrame, judges: pd.DataFrame) -> tuple[RpFigure, RpFigure]:
    """Draw stated over true errors, and the tests that each judge accepts."""
    linear, as_stated = tests["specimen"] == LINEAR, tests["stated"] == RIGHT
    plain = tests[linear & (tests["sensor"] == PLAIN.sensor) & as_stated]
    return (
        RpFigure(
            drawing=draw_stated_errors(plain, (REBUILT, OWN_BOUNDARY)),
            caption=(
                "Error that is stated over the true one, sensor of 40 dB: the rebuilt error needs no "
                "ground motion and assumes nothing of the actuator; the boundary of the motion assumes "
                "a gain and a delay."
            ),
            label="fig:rebuilt-stated",
            floats=True,
        ),
        RpFigure(
            drawing=draw_accepted_tests(judges),
            caption="Bad and good tests that each judge accepts, sensor of 40 dB.",
            label="fig:rebuilt-accepted",
            floats=True,
        ),
    )


def _tables(tables: Mapping[str, pd.DataFrame]) -> tuple[Table, ...]:
    """Tabulate verdicts by judge, by sensor and statement, by actuator and by specimen."""
    conditions, rigs, specimens = (
        tables[name][tables[name]["judge"].isin(judges)]
        for name, judges in (
            ("conditions", [REBUILT]),
            ("rigs", [REBUILT]),
            ("specimens", [REBUILT, WITH_MODEL]),
        )
    )
    condition = [
        sensor if mistake == RIGHT else f"{sensor}, {mistake}"
        for sensor, mistake in zip(conditions["sensor"], conditions["stated"], strict=True)
    ]
    with_judge = specimens["judge"].map({REBUILT: ", taken as linear", WITH_MODEL: ", with a model"})
    return (
        _table(tables["judges"], "judge", "Judge", "Judges on linear specimens, sensor of 40 dB.", "judges"),
        _table(
            conditions.assign(condition=condition),
            "condition",
            "Sensor, and what is stated wrongly",
            "The rebuilt error by sensor and by what is stated wrongly, with a tolerance of the same size.",
            "conditions",
        ),
        _table(rigs, "rig", "Actuator", "The rebuilt error by actuator, sensor of 40 dB.", "rigs"),
        _table(
            specimens.assign(named=specimens["specimen"] + with_judge),
            "named",
            "Specimen",
            "Nonlinear specimens without a model, and with one whose parameters are off by about 1 %.",
            "specimens",
        ),
    )


def _table(frame: pd.DataFrame, key: str, heading: str, caption: Prose, label: str) -> Table:
    share, ratio = Fixed(decimals=1, factor=PERCENT), Fixed(decimals=3)
    bad, good, ratio_heading = "bad tests", "good tests", "stated over true error"
    return Table(
        frame=frame,
        columns=(
            Column(key=key, heading=heading),
            Column(key="bad", heading="tried", number=Fixed(decimals=0), group=bad),
            Column(key="bad_accepted", heading="accepted", unit="%", number=share, group=bad),
            Column(key="good", heading="tried", number=Fixed(decimals=0), group=good),
            Column(key="good_accepted", heading="accepted", unit="%", number=share, group=good),
            Column(key="contained", heading="Motions contained", unit="%", number=share),
            Column(key="ratio_05", heading="5 %", number=ratio, group=ratio_heading),
            Column(key="ratio_95", heading="95 %", number=ratio, group=ratio_heading),
            Column(key="covered", heading="In interval", unit="%", number=share),
        ),
        caption=caption,
        label=f"tab:rebuilt-{label}",
    )


_HEIGHT = 92.0
_ROW = 11.0
_SHARES_HEIGHT = 40.0
_SHIFT = 0.16


@apply_style
def draw_stated_errors(tests: pd.DataFrame, judges: tuple[str, ...]) -> Figure:
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
            place.plot(PERCENT * rows["error"], PERCENT * rows["estimate"], label=rp_plain(str(name)), **look)
        place.set(xscale="log", yscale="log", xlim=ends, ylim=ends, aspect="equal")
        label_logarithmic(place.xaxis, place.yaxis)
        name_axes(place, "True error of the test [%]", "Stated error [%]" if place is axes[0, 0] else "")
    letters(axes, tuple(judges))
    legend_below(figure, axes[0, 0], columns=3)
    return figure


@apply_style
def draw_accepted_tests(rows: pd.DataFrame) -> Figure:
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
    place.set_yticks(middle, [rp_plain(str(name)) for name in rows["judge"]])
    name_axes(place, "Share of the tests [%]", "")
    legend_below(figure, place, columns=2)
    return figure
