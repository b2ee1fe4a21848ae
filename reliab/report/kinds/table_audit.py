"""Report of a published table audited row by row against a simulation of its records."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from reliab.report.document import Column, Document, Figure, Paragraph, Section, Table
from reliab.report.figures.table_rows import table_rows
from reliab.report.kinds.method import limits_section, method_section
from reliab.report.kinds.provenance import provenance_of
from reliab.report.kinds.wording import PERCENT, percent
from reliab.report.numbers import Fixed, Scientific, Significant
from reliab.report.prose import Prose, prose
from reliab.report.sources import SOURCES

_NONE_FOUND = "none found"


def table_audit_report(
    *,
    title: str,
    rows: pd.DataFrame,
    numbers: pd.DataFrame,
    provenance: Mapping[str, object],
    notes: Sequence[Prose] = (),
) -> Document:
    """Report which numbers of the paper come back, Table 2 row by row, and what differs in the others.

    Parameters
    ----------
    title : str
        Title of the report.
    rows : pandas.DataFrame
        As :func:`reliab.paper.table2_audit.audit_table2` makes it.
    numbers : pandas.DataFrame
        Every number of the paper, as :func:`reliab.paper.audit` makes it.
    provenance : mapping
        What the report can be made again from, by name.
    notes : sequence of Prose, optional
        What the reader should know.

    Returns
    -------
    Document
        The report.
    """
    rows = rows.fillna({"difference": "", "detail": ""})
    apart = rows[~rows["agrees"]]
    named = apart[apart["difference"] != _NONE_FOUND]
    before, after = (_root_mean_square(apart[name]) for name in ("gap_before", "gap_after"))
    return Document(
        kind="Audit of a published table",
        title=title,
        verdict=prose(
            "{agree} of {all} rows come back within 10 % in both $a$ and $b$; of the other {apart}, a hidden "
            "difference explains {named} better than chance would, and {rest} remain unexplained.",
            agree=int(rows["agrees"].sum()),
            all=len(rows),
            apart=len(apart),
            named=len(named),
            rest=len(apart) - len(named),
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
            _apart(rows, apart),
            _numbers(numbers),
            _all(rows),
            method_section(None, experimental_fraction=1.0, window="record"),
            limits_section(notes),
        ),
        provenance=provenance_of(provenance),
        sources=SOURCES,
    )


def _apart(rows: pd.DataFrame, apart: pd.DataFrame) -> Section:
    ratios = apart.assign(
        a_ratio=apart["a"] / apart["a_printed"],
        b_ratio=apart["b"] / apart["b_printed"],
        a_closed=apart["a_after"] / apart["a_printed"],
        b_closed=apart["b_after"] / apart["b_printed"],
    ).sort_values("gap_before", ascending=False)
    before, after = prose("simulated over printed"), prose("with the difference")
    return Section(
        title="Rows that disagree",
        blocks=(
            Paragraph(
                text=prose(
                    "For each row that disagrees, other time steps, shorter and longer stretches of the "
                    "record, and the other component of the same recording are tried. A difference is named "
                    "only when it explains $a$ and $b$ together as closely as agreeing rows agree, and when "
                    "it would rarely ({share} at most) do so for the printed pair of another earthquake: "
                    "with many candidates, chance explains much.",
                    share=percent(0.05),
                )
            ),
            Figure(
                drawing=table_rows(rows),
                caption=(
                    "Every row by its ratios; a row that is explained moves to the crossing of the lines."
                ),
                label="fig:rows",
            ),
            Table(
                frame=ratios,
                columns=(
                    Column(key="record", heading="Record"),
                    Column(key="a_ratio", heading=prose("$a$"), number=Fixed(), group=before),
                    Column(key="b_ratio", heading=prose("$b$"), number=Fixed(), group=before),
                    Column(key="difference", heading="Difference"),
                    Column(key="detail", heading="Detail", wide=True),
                    Column(key="a_closed", heading=prose("$a$"), number=Fixed(), group=after),
                    Column(key="b_closed", heading=prose("$b$"), number=Fixed(), group=after),
                    Column(
                        key="chance", heading="Chance", unit="%", number=Fixed(decimals=1, factor=PERCENT)
                    ),
                ),
                caption=(
                    "Rows that disagree by more than 10 %, the worst first; “chance” is the share of other "
                    "earthquakes' printed pairs that the row's candidates explain as well."
                ),
                label="tab:apart",
            ),
        ),
        label="sec:apart",
    )


def _numbers(numbers: pd.DataFrame) -> Section:
    known = numbers[["from_tables", "from_records"]].notna().any(axis=1)
    shown = numbers[known & ((numbers["item"] != "Table 2") | ~numbers["quantity"].str.contains(" of "))]
    shown = shown.assign(item=shown["item"].where(shown["item"] != shown["item"].shift(), ""))
    return Section(
        title="Every other number",
        blocks=(
            Paragraph(
                text=prose(
                    "Every number of Tables 1 and 3 to 6 and of equations (11) to (18), recomputed from the "
                    "tables that the paper prints and from the ellipses of its records. Differences are "
                    "relative to the printed number. What neither gives, curves and histories, is in the "
                    "report of the study paper2017."
                )
            ),
            Table(
                frame=shown,
                columns=(
                    Column(key="item", heading="Paper", wide=True),
                    Column(key="quantity", heading="Quantity", wide=True),
                    Column(key="printed", heading="Printed", number=Significant()),
                    Column(key="from_tables", heading="Its tables", number=Significant()),
                    Column(key="from_records", heading="Its records", number=Significant()),
                    Column(
                        key="difference",
                        heading="Difference",
                        unit="%",
                        number=Fixed(decimals=1, factor=PERCENT, signed=True),
                    ),
                    Column(key="finding", heading="Finding", wide=True),
                ),
                caption="What the paper prints, what follows from its tables, and what from its records.",
                label="tab:numbers",
            ),
        ),
        label="sec:numbers",
    )


def _all(rows: pd.DataFrame) -> Section:
    shown = rows.assign(
        number=np.arange(1, len(rows) + 1),
        a_ratio=rows["a"] / rows["a_printed"],
        b_ratio=rows["b"] / rows["b_printed"],
    )
    a, b = prose("$a$ [-]"), prose("$b$ [ms²]")
    return Section(
        title="All rows",
        blocks=(
            Table(
                frame=shown,
                columns=(
                    Column(key="record", heading="Record"),
                    Column(key="a_printed", heading="printed", number=Scientific(), group=a),
                    Column(key="a", heading="simulated", number=Scientific(), group=a),
                    Column(key="a_ratio", heading="ratio", number=Fixed(), group=a),
                    Column(key="b_printed", heading="printed", number=Significant(), group=b),
                    Column(key="b", heading="simulated", number=Significant(), group=b),
                    Column(key="b_ratio", heading="ratio", number=Fixed(), group=b),
                    Column(key="difference", heading="Difference"),
                ),
                caption="Every row of Table 2, printed and simulated from the raw record.",
                label="tab:all",
            ),
        ),
    )


def _root_mean_square(gaps: pd.Series) -> float:
    finite = gaps[np.isfinite(gaps)]
    return float(np.sqrt(np.mean(np.square(finite)))) if len(finite) else 0.0
