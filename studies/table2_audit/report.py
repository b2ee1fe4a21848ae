"""Report of a published table audited row by row against a simulation of its records."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from reliab_studies.paper2017.printed import CLOSE

from reliab.core.significant_digits import percent
from reliab.core.vocabulary import PERCENT
from reliab.report.document import Column, Document, Figure as RpFigure, Section, Table, provenance_of
from reliab.report.numbers import Fixed, Scientific, Significant
from reliab.report.prose import prose
from reliab.report.sections import limits_section, method_section
from reliab.report.style import (
    BLUE,
    GREY,
    INK,
    VERMILION,
    apply_style,
    label_logarithmic,
    legend_below,
    letters,
    name_axes,
    panels,
)

from .audit import LARGEST_CHANCE, NONE_FOUND


def table_audit_report(
    *,
    title: str,
    rows: pd.DataFrame,
    provenance: Mapping[str, object],
) -> Document:
    """Report which rows of Table 2 are reproduced, and what differs in the others."""
    rows = rows.fillna({"difference": "", "detail": ""})
    disagreeing = rows[~rows["agrees"]]
    explained = disagreeing[disagreeing["difference"] != NONE_FOUND]
    before, after = (_root_mean_square(disagreeing[name]) for name in ("gap_before", "gap_after"))
    return Document(
        kind="Audit of a published table",
        title=title,
        verdict=prose(
            "{agree} of {all} rows are reproduced within 10 % in both $a$ and $b$; of the other "
            "{disagreeing}, a hidden difference explains {named} better than chance would, and {rest} remain "
            "unexplained. The column “error” is reproduced in {errors} rows.",
            agree=int(rows["agrees"].sum()),
            all=len(rows),
            disagreeing=len(disagreeing),
            named=len(explained),
            rest=len(disagreeing) - len(explained),
            errors=int(((rows["error"] / rows["error_printed"] - 1.0).abs() <= CLOSE).sum()),
        ),
        facts={
            "Table": prose("Table 2 of Guo and others (2017) @guo2017"),
            "Structure": prose('$f = 1$ Hz, $xi = 0.02$; $"RMS"^R$ of 5 %'),
            "Gap of disagreeing rows": prose(
                "{before:.2f} before, {after:.2f} after (root mean square of the larger logarithmic ratio)",
                before=before,
                after=after,
            ),
        },
        blocks=(
            _disagreeing(rows, disagreeing),
            limits_section(()),
            method_section(None, experimental_fraction=1.0, window="record"),
            _list_rows(rows),
        ),
        provenance=provenance_of(provenance),
    )


def _disagreeing(rows: pd.DataFrame, disagreeing: pd.DataFrame) -> Section:
    return Section(
        title="Rows that disagree",
        blocks=(
            prose(
                "For each row that disagrees, other time steps, shorter and longer stretches of the "
                "record, and the other component of the same recording are tried. A difference is named "
                "only when it explains $a$ and $b$ together as closely as agreeing rows agree, and when "
                "it would rarely ({share} at most) do so for the printed pair of another earthquake: "
                "with many candidates, some explain a row by chance.",
                share=percent(LARGEST_CHANCE),
            ),
            RpFigure(
                drawing=table_rows(rows),
                caption=(
                    "Every row by its ratios; a row that is explained moves to the crossing of the lines."
                ),
                label="fig:rows",
                leads=True,
            ),
            _ratios(disagreeing),
        ),
        label="sec:disagreeing",
    )


def _ratios(disagreeing: pd.DataFrame) -> Table:
    """Tabulate rows that disagree before and after their hidden difference, the worst first."""
    ratios = disagreeing.assign(
        a_ratio=disagreeing["a"] / disagreeing["a_printed"],
        b_ratio=disagreeing["b"] / disagreeing["b_printed"],
        a_closed=disagreeing["a_after"] / disagreeing["a_printed"],
        b_closed=disagreeing["b_after"] / disagreeing["b_printed"],
        difference=disagreeing["difference"].str.cat(disagreeing["detail"], sep="; ").str.removesuffix("; "),
    ).sort_values("gap_before", ascending=False)
    before, after = prose("before"), prose("after")
    chance = Fixed(decimals=1, factor=PERCENT)
    return Table(
        frame=ratios,
        columns=(
            Column(key="record", heading="Record"),
            Column(key="a_ratio", heading=prose("$a$"), number=Fixed(), group=before),
            Column(key="b_ratio", heading=prose("$b$"), number=Fixed(), group=before),
            Column(key="difference", heading="Difference", wide=True),
            Column(key="a_closed", heading=prose("$a$"), number=Fixed(), group=after),
            Column(key="b_closed", heading=prose("$b$"), number=Fixed(), group=after),
            Column(key="chance", heading="Chance", unit="%", number=chance),
        ),
        caption=(
            "Rows that disagree by more than 10 %, the worst first: simulated over printed a and b, before "
            "and after the difference is taken into account; “chance” is the share of other earthquakes' "
            "printed pairs that the row's candidates explain as well."
        ),
        label="tab:disagreeing",
    )


def _list_rows(rows: pd.DataFrame) -> Section:
    worded = rows.assign(
        a_ratio=rows["a"] / rows["a_printed"],
        b_ratio=rows["b"] / rows["b_printed"],
    )
    a, b, error = prose("$a$ [-]"), prose("$b$ [ms²]"), prose("error [ms⁴]")
    return Section(
        title="All rows",
        blocks=(
            Table(
                frame=worded,
                columns=(
                    Column(key="record", heading="Record"),
                    Column(key="a_printed", heading="printed", number=Scientific(), group=a),
                    Column(key="a", heading="simulated", number=Scientific(), group=a),
                    Column(key="a_ratio", heading="ratio", number=Fixed(), group=a),
                    Column(key="b_printed", heading="printed", number=Significant(), group=b),
                    Column(key="b", heading="simulated", number=Significant(), group=b),
                    Column(key="b_ratio", heading="ratio", number=Fixed(), group=b),
                    Column(key="error_printed", heading="printed", number=Significant(), group=error),
                    Column(key="error", heading="simulated", number=Significant(), group=error),
                ),
                caption=prose(
                    "Every row of Table 2, printed and simulated from the raw record; “error” is the sum of "
                    "squares of equation (10), which is reproduced in few rows for a reason that is unknown."
                ),
                label="tab:all",
            ),
        ),
        appendix=True,
    )


def _root_mean_square(gaps: pd.Series) -> float:
    finite = gaps[np.isfinite(gaps)]
    return float(np.sqrt(np.mean(np.square(finite)))) if len(finite) else 0.0


@apply_style
def table_rows(rows: pd.DataFrame) -> Figure:
    """Draw simulated over printed ellipse parameters, row by row.

    Panels before and after; b over a, each as a ratio.
    """
    figure, axes = panels(1, 2, height=78.0, share_x=True, share_y=True)
    letters(axes, ("as simulated", "with the differences that were named"))
    explained = ~rows["agrees"] & rows["difference"].isin(["time step", "duration", "component"])
    groups = (
        ("row that agrees", rows["agrees"], {"color": GREY, "marker": "o", "fillstyle": "none"}),
        ("difference named", explained, {"color": BLUE, "marker": "s"}),
        ("none found", ~rows["agrees"] & ~explained, {"color": VERMILION, "marker": "x"}),
    )
    for place, ending in zip(axes[0], ("", "_after"), strict=True):
        for label, selection, style in groups:
            points = rows[selection]
            ratios = [points[f"{name}{ending}"] / points[f"{name}_printed"] for name in ("a", "b")]
            place.plot(*ratios, linestyle="", markersize=3.6, label=label, **style)
        place.axhline(1.0, color=INK, linewidth=0.5)
        place.axvline(1.0, color=INK, linewidth=0.5)
        place.set_xscale("log")
        place.set_yscale("log")
        label_logarithmic(place.xaxis)
        label_logarithmic(place.yaxis)
        name_axes(place, "$a$, simulated over printed [-]", "")
    axes[0, 0].set_ylabel("$b$, simulated over printed [-]")
    legend_below(figure, axes[0, 0])
    return figure
