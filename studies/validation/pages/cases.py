"""The four cases of the paper: their verdicts and errors beside what is printed."""

import pandas as pd
import xarray as xr
from reliab_studies.paper2017.cases import case_table
from reliab_studies.paper2017.pages.case_histories import case_histories

from reliab.report import Column, Fixed, Paragraph, Section, Shortest, Table, Whole
from reliab.report.prose import prose
from reliab.vocabulary import MILLI, PERCENT


def cases_section(cases: xr.Dataset) -> Section:
    """Show the verdicts of equation (18) on the four cases, their errors, and what the paper prints."""
    seconds = f"{cases.attrs.get('window', 0.0):g}"
    caption = "Exact response and measured displacement of the four cases."
    return Section(
        title="The four cases of the paper",
        blocks=(
            Paragraph(
                text=prose(
                    "The application of the paper @guo2017, simulated under {motion}: $A$ and $d$ are those "
                    "of command and measured displacement, the index is that of equation (18), and a test "
                    'is good while its $"RMS"^R$ is at most 5 %. The error is that over the first '
                    "{seconds} s of the record, relative to the peak of the exact response; the last column "
                    "gives it relative to the RMS of the exact response (@tab:cases).",
                    motion=str(cases.attrs.get("motion", "one motion")),
                    seconds=seconds,
                )
            ),
            _table(case_table(cases), seconds),
            case_histories(cases, caption=caption, label="fig:cases"),
        ),
    )


def _table(frame: pd.DataFrame, seconds: str) -> Table:
    number, ratio, good = Fixed(decimals=3), Fixed(factor=PERCENT), prose('$"RMS"^R$')
    simulated, printed, index, verdict = "simulated", "printed", "index of (18)", "index at most 1"
    of_rms = Fixed(decimals=1, factor=PERCENT)
    return Table(
        frame=frame,
        columns=(
            Column(key="case", heading="Case", number=Whole()),
            Column(key="f", heading=prose("$f$"), unit="Hz", number=Shortest()),
            Column(key="xi", heading=prose("$xi$"), unit="-", number=Shortest()),
            Column(key="A", heading=prose("$A$"), unit="-", number=Fixed(decimals=4)),
            Column(key="d", heading=prose("$d$"), unit="ms", number=Fixed(factor=MILLI)),
            Column(key="index", heading=simulated, unit="-", number=number, group=index),
            Column(key="index_printed", heading=printed, unit="-", number=number, group=index),
            Column(key="accepted", heading=simulated, group=verdict),
            Column(key="accepted_printed", heading=printed, group=verdict),
            Column(key="rms", heading=simulated, unit="%", number=ratio, group=good),
            Column(key="rms_printed", heading=printed, unit="%", number=ratio, group=good),
            Column(key="good", heading="good"),
            Column(key="of_rms", heading="of its RMS", unit="%", number=of_rms),
        ),
        caption=prose(
            "Verdicts of equation (18), errors over the first {seconds} s, and what is printed.",
            seconds=seconds,
        ),
        label="tab:cases",
    )
