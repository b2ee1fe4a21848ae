"""Report of a validation: whether criteria keep their promise on motions they have not seen."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from reliab.criterion.laws import OF_MANY_MOTIONS
from reliab.report.document import Block, Column, Document, Figure, Paragraph, Section, Table
from reliab.report.figures.beyond_the_model import error_beyond_the_model
from reliab.report.figures.displacement_histories import HistoryPanel, displacement_histories
from reliab.report.kinds.method import limits_section, method_section
from reliab.report.kinds.provenance import provenance_of
from reliab.report.kinds.rates import rates_section
from reliab.report.kinds.wording import PERCENT, percent
from reliab.report.numbers import Fixed, Shortest, Whole
from reliab.report.prose import Prose, prose
from reliab.report.sources import SOURCES

_MILLISECONDS = 1e3


def validation_report(
    *,
    title: str,
    rates: Mapping[str, pd.DataFrame],
    confidence: float,
    experimental_fraction: float = 1.0,
    window: str = "record",
    verdicts: pd.DataFrame | None = None,
    beyond: pd.DataFrame | None = None,
    cases: xr.Dataset | None = None,
    provenance: Mapping[str, object],
    notes: Sequence[Prose] = (),
    purpose: str = "",
) -> Document:
    """Report how criteria did on motions that they were not learned from.

    Parameters
    ----------
    title : str
        Title of the report.
    rates : mapping of str to pandas.DataFrame
        What was found by the name of each division into learned and judged motions, each as
        :func:`reliab.report.kinds.rates.rates_table` makes it; the verdict is that of the first, and in
        it of the first criterion.
    confidence : float
        The confidence that the verdict speaks of [-].
    experimental_fraction : float, optional
        Share of the stiffness in the laboratory [-].
    window : str, optional
        Where errors were taken.
    verdicts : pandas.DataFrame, optional
        What became of simulated tests in the first division: columns `candidate`, `confidence`,
        `good_accepted`, `good_rejected`, `bad_accepted`, `bad_rejected`, as
        :func:`reliab.validation.cross_validation.tabulation.tabulate` makes it.
    beyond : pandas.DataFrame, optional
        Tests with actuators that are no constant gain and delay, as
        :func:`reliab.validation.beyond_the_model.try_rigs` makes it.
    cases : xarray.Dataset, optional
        The paper's four cases, from :func:`reliab.paper.cases.cases_dataset`.
    provenance : mapping
        What the report can be made again from, by name.
    notes : sequence of Prose, optional
        What the reader should know.
    purpose : str, optional
        What the study is for, for the first page.

    Returns
    -------
    Document
        The report.
    """
    blocks: list[Block] = [
        rates_section(table, confidence=confidence, division=name) for name, table in rates.items()
    ]
    if verdicts is not None and len(verdicts):
        blocks.append(_confusion(verdicts, confidence))
    if beyond is not None and len(beyond):
        blocks.append(_beyond(beyond))
    if cases is not None:
        blocks.append(_cases(cases))
    blocks += [
        method_section(None, experimental_fraction=experimental_fraction, window=window),
        limits_section(notes),
    ]
    verdict, tone = _verdict(next(iter(rates.values())), confidence)
    return Document(
        kind="Validation of criteria",
        title=title,
        verdict=verdict,
        tone="good" if tone else "bad",
        facts={"Divisions": ", ".join(rates), "Confidence": percent(confidence), "Purpose": purpose},
        blocks=tuple(blocks),
        provenance=provenance_of(provenance),
        sources=SOURCES,
    )


def _verdict(rates: pd.DataFrame, confidence: float) -> tuple[Prose, bool]:
    """Say what the first criterion contained, and whether that agrees with what it states."""
    overall = rates[(rates["measure"] == "containment") & rates["f"].isna()]
    nearest = overall.iloc[[int(np.argmin(np.abs(overall["confidence"] - confidence)))]]
    row = nearest.iloc[0]
    keeps = bool(row["high"] >= row["confidence"])
    unsafe = rates[
        (rates["measure"] == "false_safe")
        & rates["f"].isna()
        & (rates["candidate"] == row["candidate"])
        & np.isclose(rates["confidence"], row["confidence"])
    ]
    ending = (
        ""
        if unsafe.empty
        else f", and {percent(unsafe.iloc[0]['rate'], 2)} of the tests that it accepts exceed their error"
    )
    verdict = prose(
        "The criterion “{name}”, which states {stated}, {word} its promise: {rate} of motions of held-out "
        "earthquakes contain it (95 % interval {low} to {high}){ending}.",
        name=row["candidate"],
        stated=percent(row["confidence"]),
        word="keeps" if keeps else "does not keep",
        rate=percent(row["rate"]),
        low=percent(row["low"]),
        high=percent(row["high"]),
        ending=ending,
    )
    return verdict, keeps


def _confusion(verdicts: pd.DataFrame, confidence: float) -> Section:
    chosen = verdicts[np.isclose(verdicts["confidence"], confidence)]
    good, bad = prose("good tests"), prose("bad tests")
    return Section(
        title="Verdicts on simulated tests",
        blocks=(
            Table(
                frame=chosen,
                columns=(
                    Column(key="candidate", heading="Criterion"),
                    Column(key="good_accepted", heading="accepted", number=Whole(), group=good),
                    Column(key="good_rejected", heading="refused", number=Whole(), group=good),
                    Column(key="bad_accepted", heading="accepted", number=Whole(), group=bad),
                    Column(key="bad_rejected", heading="refused", number=Whole(), group=bad),
                ),
                caption=prose(
                    "Verdicts of the criteria that state {share} on tests whose amplitude errors and delays "
                    "lie evenly around the boundaries, each under a motion of a held-out earthquake; a test "
                    "is good when its simulated error stays below the threshold.",
                    share=percent(confidence),
                ),
                label="tab:confusion",
            ),
        ),
    )


def _beyond(tests: pd.DataFrame) -> Section:
    grouped = tests.assign(
        excess=(tests["error"] - tests["predicted"]).abs() / tests["predicted"],
        unsafe=tests["accepted"] & ~tests["good"],
        wasted=~tests["accepted"] & tests["good"],
    ).groupby("rig", sort=False)
    table = grouped.agg(
        tests=("error", "size"),
        typical=("excess", "median"),
        worst=("excess", "max"),
        accepted=("accepted", "sum"),
        unsafe=("unsafe", "sum"),
        wasted=("wasted", "sum"),
    ).reset_index()
    share = Fixed(decimals=1, factor=PERCENT)
    return Section(
        title="Actuators that are no constant gain and delay",
        blocks=(
            Paragraph(
                text=prose(
                    "Each test was simulated with its actuator; $A$ and $d$ were evaluated from command and "
                    "measured displacement as a laboratory would, and the error was compared with that of a "
                    "constant gain $A$ and delay $d$ (@fig:beyond, @tab:beyond)."
                )
            ),
            Figure(
                drawing=error_beyond_the_model(tests),
                caption=(
                    "Error of each test over the error that a constant gain and delay would have made: on "
                    "the diagonal, A and d tell all that matters."
                ),
                label="fig:beyond",
            ),
            Table(
                frame=table,
                columns=(
                    Column(key="rig", heading="Actuator"),
                    Column(key="tests", heading="Tests", number=Whole()),
                    Column(
                        key="typical", heading="median", unit="%", number=share, group="off the prediction"
                    ),
                    Column(key="worst", heading="worst", unit="%", number=share, group="off the prediction"),
                    Column(key="accepted", heading="Accepted", number=Whole()),
                    Column(key="unsafe", heading="Accepted, yet bad", number=Whole()),
                    Column(key="wasted", heading="Good, yet refused", number=Whole()),
                ),
                caption="What became of verdicts on actuators beyond the model.",
                label="tab:beyond",
            ),
        ),
    )


def _cases(cases: xr.Dataset) -> Section:
    law = OF_MANY_MOTIONS["guo_2017_18"]
    a, b = law.limits(cases["f"].values, cases["xi"].values)
    index = (cases["A"].values - 1.0) ** 2 / a + (_MILLISECONDS * cases["d"].values) ** 2 / b
    frame = cases[["f", "xi", "A", "d", "rms"]].to_dataframe().reset_index().assign(index=index)
    times = cases["time"].values
    panels = [
        HistoryPanel(
            title=f"case {number}",
            times=times,
            ideal=cases["ideal"].sel(case=number).values,
            measured=cases["measured"].sel(case=number).values,
        )
        for number in cases["case"].values.tolist()
    ]
    return Section(
        title="The four cases of the paper",
        blocks=(
            Table(
                frame=frame,
                columns=(
                    Column(key="case", heading="Case", number=Whole()),
                    Column(key="f", heading=prose("$f$"), unit="Hz", number=Shortest()),
                    Column(key="xi", heading=prose("$xi$"), unit="-", number=Shortest()),
                    Column(key="A", heading=prose("$A$"), unit="-", number=Fixed(decimals=4)),
                    Column(key="d", heading=prose("$d$"), unit="ms", number=Fixed(factor=_MILLISECONDS)),
                    Column(key="index", heading="Index of (18)", unit="-", number=Fixed(decimals=3)),
                    Column(key="rms", heading=prose('$"RMS"^R$'), unit="%", number=Fixed(factor=PERCENT)),
                ),
                caption=prose("The application of the paper @guo2017, simulated again."),
                label="tab:cases",
            ),
            Figure(
                drawing=displacement_histories(panels),
                caption="Exact response and measured displacement of the four cases.",
                label="fig:cases",
            ),
        ),
    )
