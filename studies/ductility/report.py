"""Report of what tests with nonlinear specimens tolerate."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reliab.core.significant_digits import counted, percent
from reliab.core.vocabulary import PERCENT
from reliab.report.document import Column, Document, Figure as RpFigure, Points, Section, Table, provenance_of
from reliab.report.numbers import Fixed, Shortest
from reliab.report.prose import Prose, prose, values
from reliab.report.style import (
    INK,
    apply_style,
    label_logarithmic,
    legend_below,
    letters,
    line,
    name_axes,
    panels,
)

from .tolerances import FARTHEST

_NAMES = {
    "bilinear": "bilinear",
    "bouc_wen": "Bouc–Wen",
    "coulomb": "Coulomb friction",
    "cubic": "cubic spring",
}
_RATIO = Fixed(decimals=2)


def ductility_report(
    *,
    title: str,
    levels: pd.DataFrame,
    limits: pd.DataFrame,
    provenance: Mapping[str, object],
    purpose: str = "",
) -> Document:
    """Report tolerances of nonlinear over those of linear tests.

    `limits`: as `compare_limits` gives it, with `alpha` and `threshold` [-].
    """
    overall = levels[levels["f"].isna() & (levels["direction"] == "narrowest")]
    narrower = float((overall["narrower"] * overall["tests"]).sum() / overall["tests"].sum())
    threshold = float(limits["threshold"].iloc[0])
    structures = limits[["f", "xi"]].drop_duplicates()
    return Document(
        kind="Tolerance and ductility",
        title=title,
        verdict=prose(
            "Of {tests} with a nonlinear specimen, {narrower} tolerate less delay or amplitude error "
            "in some direction than the linear test under the same ground motion: a linear specimen is "
            "{worst}.",
            tests=counted(int(overall["tests"].sum()), "test"),
            narrower=percent(narrower, decimals=1),
            worst="the worst case of all of them" if narrower == 0.0 else "not the worst case",
        ),
        facts={
            "Motions": str(int(overall["motions"].max())),
            "Earthquakes": str(int(overall["events"].max())),
            "Structures": f"{values(sorted(set(structures['f'])), 'Hz')} with "
            f"{values(sorted(set(PERCENT * structures['xi'])), '%')} damping",
            "Error": f"{percent(threshold)} RMS",
            "Purpose": purpose,
            "To do next": "judge a test with a nonlinear specimen by its own error, with reliab assess",
        },
        blocks=(_method(limits), _levels(levels, overall), _limits(limits)),
        provenance=provenance_of(provenance),
    )


def _method(limits: pd.DataFrame) -> Section:
    text = prose(
        "The specimen carries {alpha} of the structure's stiffness. Its level is scaled by the linear "
        "response: $R$ is the peak of the linear response over the yield displacement; friction and cubic "
        "forces are given over the force of the linear spring at that peak. Starting from the perfect "
        "actuator, a delay, a gain above or below 1, or both together, are increased until the error of the "
        "whole test, relative to the exact response of the same nonlinear structure, first reaches "
        "{threshold}. That tolerance is divided by the one of the linear test: above 1 the nonlinear test "
        "tolerates more. Tolerances are sought up to {farthest:g} times the linear one of small errors; "
        "larger ones count with that value.",
        farthest=FARTHEST,
        alpha=percent(float(limits["alpha"].iloc[0])),
        threshold=percent(float(limits["threshold"].iloc[0])),
    )
    return Section(title="What is compared", blocks=(text,))


def _levels(levels: pd.DataFrame, narrowest: pd.DataFrame) -> Section:
    overall = levels[levels["f"].isna()]
    medians = overall.pivot_table(
        index=["specimen", "level"], columns="direction", values="q50"
    ).reset_index()
    frame = narrowest.merge(medians, on=["specimen", "level"], sort=False)
    frame["name"] = [_NAMES.get(kind, kind) for kind in frame["specimen"]]
    return Section(
        title="Tolerance over the level of the specimen",
        blocks=(
            Points(items=tuple(_describe_kinds(frame))),
            _table_of_levels(frame),
            RpFigure(
                drawing=tolerance_over_level(levels),
                caption="Tolerance over that of the linear test: median, middle half and 90 % of the tests "
                "over all structures. Below 1 the nonlinear test is the more demanding one.",
                label="fig:levels",
                leads=True,
            ),
        ),
    )


def _table_of_levels(frame: pd.DataFrame) -> Table:
    share = Fixed(decimals=1, factor=PERCENT)
    columns = (
        Column(key="name", heading="Specimen", wide=True),
        Column(key="level", heading="Level", number=Shortest()),
        Column(key="ductility", heading="Ductility", number=_RATIO),
        Column(key="tests", heading="Tests", number=Fixed(decimals=0)),
        Column(key="lost", heading="Lost", number=Fixed(decimals=0)),
        *(
            Column(key=key, heading=heading, number=_RATIO, group="Median tolerance over linear")
            for key, heading in (("late", "Delay"), ("large", "Gain > 1"), ("small", "Gain < 1"))
        ),
        Column(key="q05", heading="5 %", number=_RATIO, group="Narrowest direction"),
        Column(key="narrower", heading="Below 1", unit="%", number=share, group="Narrowest direction"),
        Column(key="low", heading="From", unit="%", number=share, group="Narrowest direction"),
        Column(key="high", heading="To", unit="%", number=share, group="Narrowest direction"),
    )
    caption = (
        "Tolerance over that of the linear test. Ductility is the median peak of the exact response over "
        "the yield displacement. For the direction in which a test has lost most: the 5 % quantile, and the "
        "share of tests that tolerate less than the linear one with its 95 % interval over earthquakes. Lost "
        "tests, whose exact response runs away, are not counted."
    )
    return Table(frame=frame, columns=columns, caption=caption, label="tab:levels")


def _describe_kinds(frame: pd.DataFrame) -> list[Prose]:
    """Say for each kind what was measured over its levels."""
    items: list[Prose] = []
    for kind, group in frame.groupby("name", sort=False):
        shares = [percent(share, decimals=1) for share in (group["narrower"].min(), group["narrower"].max())]
        items.append(
            prose(
                "*{kind}*: over levels from {first} to {last} the median tolerable delay is "
                "{least:.2f} to {most:.2f} times the linear one; {narrower} of the tests of a level tolerate "
                "less than the linear test in some direction.",
                kind=str(kind),
                first=Shortest()(group["level"].min()).digits,
                last=Shortest()(group["level"].max()).digits,
                least=group["late"].min(),
                most=group["late"].max(),
                narrower=" to ".join(dict.fromkeys(shares)),
            )
        )
    return items


def _limits(limits: pd.DataFrame) -> Section:
    if limits["delay_ms"].isna().all():
        text = "Too few ground motions for a limit that 95 % of them keep."
        return Section(title="Limits that 95 % of the motions keep", blocks=(text,))
    ratios = limits.assign(
        delay=limits["delay_ms"] / limits["linear_delay_ms"],
        gain=limits["amplitude"] / limits["linear_amplitude"],
    )
    grouped = ratios.groupby(["specimen", "level"], sort=False)
    frame = grouped.agg(
        delay_least=("delay", "min"),
        delay_most=("delay", "max"),
        gain_least=("gain", "min"),
        gain_most=("gain", "max"),
    ).reset_index()
    frame["name"] = [_NAMES.get(kind, kind) for kind in frame["specimen"]]
    columns = (
        Column(key="name", heading="Specimen", wide=True),
        Column(key="level", heading="Level", number=Shortest()),
        Column(key="delay_least", heading="Least", number=_RATIO, group="Delay alone"),
        Column(key="delay_most", heading="Most", number=_RATIO, group="Delay alone"),
        Column(key="gain_least", heading="Least", number=_RATIO, group="Amplitude error alone"),
        Column(key="gain_most", heading="Most", number=_RATIO, group="Amplitude error alone"),
    )
    caption = (
        "The delay alone and the amplitude error alone that 95 % of the motions tolerate, over those of the "
        "linear structure; least and most over the structures. Below 1 a criterion for linear structures "
        "promises too much for this specimen. A response that runs away tolerates nothing."
    )
    table = Table(frame=frame, columns=columns, caption=caption, label="tab:limits")
    return Section(title="Limits that 95 % of the motions keep", blocks=(table,))


_HEIGHT = 122.0
_DIRECTIONS = {"late": "delay alone", "large": "gain above 1 alone", "small": "gain below 1 alone"}
_SPACING = 0.22  # of the distance between levels
_LEVELS = {
    "bilinear": "Linear peak over yield displacement $R$ [-]",
    "bouc_wen": "Linear peak over yield displacement $R$ [-]",
    "coulomb": "Friction over spring force [-]",
    "cubic": "Cubic over linear spring force [-]",
}
_TITLES = {
    "bilinear": "bilinear",
    "bouc_wen": "Bouc–Wen",
    "coulomb": "Coulomb friction",
    "cubic": "cubic spring",
}


@apply_style
def tolerance_over_level(levels: pd.DataFrame) -> Figure:
    """Draw quantiles of the tolerance over that of the linear test, one panel for each kind of specimen."""
    kinds = list(dict.fromkeys(levels["specimen"]))
    columns = min(2, len(kinds))
    rows = -(-len(kinds) // columns)
    figure, axes = panels(rows, columns, height=_HEIGHT * rows / 2.0 + 8.0, share_y=True)
    letters(axes, tuple(_TITLES.get(kind, kind) for kind in kinds))
    overall = levels[levels["f"].isna()]
    for rank, (kind, place) in enumerate(zip(kinds, axes.ravel(), strict=False)):
        _draw(place, overall[overall["specimen"] == kind])
        first = rank % columns == 0
        name_axes(place, _LEVELS.get(kind, "Level [-]"), "Tolerance over linear [-]" if first else "")
    for place in axes.ravel()[len(kinds) :]:
        place.set_axis_off()
    label_logarithmic(axes[0, 0].yaxis, largest_count=7)
    legend_below(figure, axes[0, 0], columns=3)
    return figure


def _draw(place: Axes, levels: pd.DataFrame) -> None:
    """Draw one kind of specimen: its levels side by side, the directions around each."""
    present = sorted(set(levels["level"]))
    place.axhline(1.0, color=INK, linewidth=0.9)
    for rank, (direction, name) in enumerate(_DIRECTIONS.items()):
        quantiles = levels[levels["direction"] == direction].set_index("level").loc[present]
        at = np.arange(len(present)) + _SPACING * (rank - 1)
        look = line(rank, marker=True) | {"linestyle": "none"}
        place.vlines(at, quantiles["q05"], quantiles["q95"], color=look["color"], linewidth=0.8)
        place.vlines(at, quantiles["q25"], quantiles["q75"], color=look["color"], linewidth=2.6)
        place.plot(at, quantiles["q50"], label=name, markersize=4.6, **look)
    place.set(yscale="log", xticks=range(len(present)), xlim=(-0.5, len(present) - 0.5))
    place.set_xticklabels([f"{level:g}".replace("-", "−") for level in present])
