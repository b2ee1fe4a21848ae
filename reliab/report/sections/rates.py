"""What criteria contain on motions that they were not learned from: table, section and figures."""

import re
from collections.abc import Iterator

import numpy as np
import pandas as pd

from reliab.report.document import Column, Figure, Paragraph, Section, Table
from reliab.report.figures.rates import calibration_curve, coverage_by_frequency
from reliab.report.numbers import Fixed, Shortest
from reliab.report.prose import prose
from reliab.report.wording import law_in_words
from reliab.significant import percent
from reliab.validation.cross_validation import CrossValidation, tabulate
from reliab.vocabulary import PERCENT

_MEANINGS = {
    "containment": ("contained", "motions that contain the criterion"),
    "false_safe": (
        "accepted, yet bad",
        "tests that are accepted although their error is too large, of those accepted",
    ),
    "accepted_share": ("good, and accepted", "good tests that are accepted, of those good"),
}
"""Heading and meaning of each rate that reports show."""

MEASURES = tuple(_MEANINGS)
"""Rates that reports show."""


def rates_table(validation: CrossValidation) -> pd.DataFrame:
    """Tabulate what a cross-validation found, over all structures and by frequency.

    Returns columns `measure` ("containment", "false_safe" or "accepted_share"), `candidate`, `confidence`
    (stated), `f` [Hz] (NaN over all structures), `rate`, `low` and `high` [-].
    """
    columns = ["measure", "candidate", "confidence", "f", "rate", "low", "high"]
    parts = []
    for table in (tabulate(validation, over) for over in (("f", "xi"), ("xi",))):
        for measure in MEASURES:
            ends = {"rate": table[measure], "low": table[f"{measure}_low"], "high": table[f"{measure}_high"]}
            parts.append(table.assign(measure=measure, **ends).reindex(columns=columns))
    return pd.concat(parts, ignore_index=True).dropna(subset="rate").reset_index(drop=True)


def rates_section(
    rates: pd.DataFrame, *, confidence: float, division: str = "", leads: bool = False
) -> Section:
    """Show what criteria contain.

    `confidence` [-].
    Returns calibration curve, containment by frequency, and the rates as a table; labelled `sec:coverage`,
    followed by the division where there is one.
    """
    measured = rates if "measure" in rates else rates.assign(measure="containment")
    measured = measured.assign(candidate=[law_in_words(str(name)) for name in measured["candidate"]])
    mark = "".join(f"-{word.lower()}" for word in re.findall(r"[A-Za-z0-9]+", division))
    explained = "Whole earthquakes were held out in turn" if not division else f"Division: {division}"
    opening = Paragraph(
        text=prose(
            "{explained}; the criterion was derived from other earthquakes than those on which it was "
            "judged. A motion contains a criterion when the simulated error under it stays below the "
            "threshold along the whole edge of the criterion. Intervals resample earthquakes @davison1997.",
            explained=explained,
        )
    )
    contained = measured[measured["measure"] == "containment"]
    return Section(
        title=f"Put to the test: {division}" if division else "Put to the test on held-out earthquakes",
        blocks=(
            opening,
            *_figures(contained, confidence, mark, leads=leads),
            _table(measured[measured["f"].isna()], mark),
        ),
        label=f"sec:coverage{mark}",
    )


def _figures(contained: pd.DataFrame, confidence: float, mark: str, *, leads: bool) -> Iterator[Figure]:
    overall = contained[contained["f"].isna()]
    several = overall.groupby("candidate")["confidence"].transform("nunique") > 1
    yield Figure(
        drawing=calibration_curve(overall[several] if several.any() else overall),
        caption=prose(
            "A criterion keeps its promise for the motions of a study where its line follows the diagonal; "
            "below the diagonal it promises too much.{printed}",
            printed=" Printed laws state one confidence only and are listed in the table."
            if several.any() and not several.all()
            else "",
        ),
        label=f"fig:calibration{mark}",
        leads=leads,
    )
    stated = contained["confidence"].to_numpy()
    nearest = float(stated[np.argmin(np.abs(stated - confidence))])
    chosen = contained[contained["f"].notna() & np.isclose(contained["confidence"], nearest)]
    if chosen["f"].unique().size > 1:
        yield Figure(
            drawing=coverage_by_frequency(chosen, confidence=nearest),
            caption=prose(
                "Containment by natural frequency at a stated {share}: a point below the dotted line is "
                "unsafe at that frequency, as far as its interval lies below it. Criteria that are contained "
                "by far fewer motions than they state are drawn in separate axes.",
                share=percent(nearest),
            ),
            label=f"fig:by-frequency{mark}",
            floats=True,
        )


def _table(overall: pd.DataFrame, mark: str) -> Table:
    wide = overall.pivot_table(
        index=["candidate", "confidence"], columns="measure", values=["rate", "low", "high"], sort=False
    )
    wide.columns = pd.Index([" ".join(reversed(name)) for name in wide.columns.to_flat_index()])
    frame = wide.reset_index()
    share = Fixed(decimals=1, factor=PERCENT)
    shown = {name: texts for name, texts in _MEANINGS.items() if f"{name} rate" in frame}
    columns = [
        Column(key=f"{measure} {value}", heading=heading, unit="%", number=share, group=group)
        for measure, (group, _) in shown.items()
        for value, heading in (("rate", "share"), ("low", "from"), ("high", "to"))
        if f"{measure} {value}" in frame
    ]
    meanings = "; ".join(meaning for _, meaning in shown.values())
    return Table(
        frame=frame,
        columns=(
            Column(key="candidate", heading="Criterion"),
            Column(key="confidence", heading="Stated", unit="%", number=Shortest(factor=PERCENT)),
            *columns,
        ),
        caption=f"Rates over all structures with their 95 % intervals: {meanings}.",
        label=f"tab:rates{mark}",
    )
