"""Report of a validation: whether criteria keep their promise on motions they have not seen."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from reliab.paper.cases import case_table
from reliab.report.document import Block, Column, Document, Figure, Paragraph, Section, Table
from reliab.report.figures.beyond_the_model import error_beyond_the_model
from reliab.report.figures.displacement_histories import HistoryPanel, displacement_histories
from reliab.report.kinds.validation.rebuilt_error import rebuilt_error_section
from reliab.report.numbers import Fixed, Shortest, Whole
from reliab.report.prose import Prose, prose
from reliab.report.provenance import provenance_of
from reliab.report.sections.limits import limits_section
from reliab.report.sections.method import method_section
from reliab.report.sections.rates import rates_section
from reliab.report.sources import SOURCES
from reliab.report.wording import PERCENT, law_in_words, percent

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
    rebuilt: pd.DataFrame | None = None,
    threshold: float = 0.05,
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
        :func:`reliab.report.sections.rates.rates_table` makes it; the verdict is that of the first, and in
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
    rebuilt : pandas.DataFrame, optional
        Tests that are judged by their rebuilt error too, as
        :func:`reliab.validation.rebuilt_error_study.try_tests` makes it.
    threshold : float, optional
        Error up to which these tests are good [-].
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
    if rebuilt is not None and len(rebuilt):
        blocks.append(rebuilt_error_section(rebuilt, threshold))
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
    chosen = chosen.assign(candidate=[law_in_words(str(name)) for name in chosen["candidate"]])
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
        bad=~tests["good"],
        unsafe=tests["accepted"] & ~tests["good"],
        wasted=~tests["accepted"] & tests["good"],
    ).groupby("rig", sort=False)
    table = grouped.agg(
        tests=("error", "size"),
        typical=("excess", "median"),
        worst=("excess", "max"),
        bad=("bad", "sum"),
        accepted=("accepted", "sum"),
        unsafe=("unsafe", "sum"),
        wasted=("wasted", "sum"),
    ).reset_index()
    share, off = Fixed(decimals=1, factor=PERCENT), "off the prediction"
    return Section(
        title="Actuators that are no constant gain and delay",
        blocks=(
            Paragraph(
                text=prose(
                    "Each test was simulated with its actuator; $A$ and $d$ were evaluated from command and "
                    "measured displacement as a laboratory would, and the error was compared with that of a "
                    "constant gain $A$ and delay $d$ (@fig:beyond, @tab:beyond). The delays stand below and "
                    "above what the criterion allows and what the motion of each test tolerates, so that "
                    "good and bad tests are accepted or refused as the criterion decides."
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
                    Column(key="rig", heading="Actuator", wide=True),
                    Column(key="tests", heading="Tests", number=Whole()),
                    Column(key="typical", heading="median", unit="%", number=share, group=off),
                    Column(key="worst", heading="worst", unit="%", number=share, group=off),
                    Column(key="bad", heading="Bad", number=Whole()),
                    Column(key="accepted", heading="Accepted", number=Whole()),
                    Column(key="unsafe", heading="Accepted, yet bad", number=Whole()),
                    Column(key="wasted", heading="Good, yet refused", number=Whole()),
                ),
                caption=(
                    "Verdicts on actuators beyond the model; a test is bad when its own simulated error "
                    "exceeds the threshold."
                ),
                label="tab:beyond",
            ),
        ),
    )


def _cases(cases: xr.Dataset) -> Section:
    """Show the verdicts of equation (18) on the four cases, their errors, and what the paper prints."""
    frame = case_table(cases)
    seconds, good, number = f"{cases.attrs.get('window', 0.0):g}", prose('$"RMS"^R$'), Fixed(decimals=3)
    times, ratio = cases["time"].values, Fixed(factor=PERCENT)
    simulated, printed, verdict = "simulated", "printed", "index at most 1"
    panels = [
        HistoryPanel(
            title=f"case {case}",
            times=times,
            ideal=cases["ideal"].sel(case=case).values,
            measured=cases["measured"].sel(case=case).values,
        )
        for case in cases["case"].values.tolist()
    ]
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
            Table(
                frame=frame,
                columns=(
                    Column(key="case", heading="Case", number=Whole()),
                    Column(key="f", heading=prose("$f$"), unit="Hz", number=Shortest()),
                    Column(key="xi", heading=prose("$xi$"), unit="-", number=Shortest()),
                    Column(key="A", heading=prose("$A$"), unit="-", number=Fixed(decimals=4)),
                    Column(key="d", heading=prose("$d$"), unit="ms", number=Fixed(factor=_MILLISECONDS)),
                    Column(key="index", heading=simulated, unit="-", number=number, group="index of (18)"),
                    Column(
                        key="index_printed", heading=printed, unit="-", number=number, group="index of (18)"
                    ),
                    Column(key="accepted", heading=simulated, group=verdict),
                    Column(key="accepted_printed", heading=printed, group=verdict),
                    Column(key="rms", heading=simulated, unit="%", number=ratio, group=good),
                    Column(key="rms_printed", heading=printed, unit="%", number=ratio, group=good),
                    Column(key="good", heading="good"),
                    Column(
                        key="of_rms", heading="of its RMS", unit="%", number=Fixed(decimals=1, factor=PERCENT)
                    ),
                ),
                caption=prose(
                    "Verdicts of equation (18), errors over the first {seconds} s, and what is printed.",
                    seconds=seconds,
                ),
                label="tab:cases",
            ),
            Figure(
                drawing=displacement_histories(panels),
                caption="Exact response and measured displacement of the four cases.",
                label="fig:cases",
            ),
        ),
    )
