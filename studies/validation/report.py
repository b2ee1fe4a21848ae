"""Report of a validation: whether criteria keep their promise on motions they have not seen."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from reliab_studies.paper2017.cases import case_table
from reliab_studies.paper2017.pages.displacement_histories import case_histories

from reliab.core.significant_digits import percent, percent_and_interval
from reliab.core.vocabulary import MILLI, PERCENT
from reliab.report.document import Block, Column, Document, Figure as RpFigure, Section, Table, provenance_of
from reliab.report.numbers import Fixed, Shortest
from reliab.report.prose import Prose, law_in_words, prose
from reliab.report.sections import limits_section, method_section, rates_section
from reliab.report.style import (
    GREY,
    apply_style,
    label_logarithmic,
    legend_below,
    line,
    name_axes,
    panels,
    plain,
)

from .rebuilt_error import rebuilt_error_section

_NEXT = {
    True: "use the criterion for the kind of ground motions, actuators and structures that were tried here",
    False: "use a criterion whose line in the figure follows the diagonal, or state what this one contains",
}


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

    `confidence`: the confidence that the verdict speaks of [-]; `experimental_fraction`: share of the
    stiffness in the laboratory [-]; `verdicts`: what became of simulated tests in the first division: columns
    `candidate`, `confidence`, `good_accepted`, `good_rejected`, `bad_accepted`, `bad_rejected`, as
    :func:`reliab.validation.counts.tabulate` makes it; `threshold`: error up to which these
    tests are good [-].
    """
    blocks = _rates(rates, confidence)
    if verdicts is not None and len(verdicts):
        blocks.append(verdicts_section(verdicts, confidence))
    if beyond is not None and len(beyond):
        blocks.append(actuators_section(beyond))
    if rebuilt is not None and len(rebuilt):
        blocks.append(rebuilt_error_section(rebuilt, threshold))
    if cases is not None:
        blocks.append(cases_section(cases))
    blocks += [
        limits_section(notes),
        method_section(None, experimental_fraction=experimental_fraction, window=window),
    ]
    verdict, tone = _verdict(next(iter(rates.values())), confidence)
    return Document(
        kind="Validation of criteria",
        title=title,
        verdict=verdict,
        tone="good" if tone else "bad",
        facts={
            "Divisions": ", ".join(rates),
            "Confidence": percent(confidence),
            "Purpose": purpose,
            "To do next": _NEXT[tone],
        },
        blocks=tuple(blocks),
        provenance=provenance_of(provenance),
    )


def _rates(rates: Mapping[str, pd.DataFrame], confidence: float) -> list[Block]:
    """One section for each division; the curve of the first stands on the first page."""
    return [
        rates_section(table, confidence=confidence, division=name, leads=not place)
        for place, (name, table) in enumerate(rates.items())
    ]


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
        else f", and {percent(unsafe.iloc[0]['rate'], decimals=1)} of the tests that it accepts are bad"
    )
    rate, ends = percent_and_interval(row["rate"], row["low"], row["high"])
    verdict = prose(
        "The criterion “{name}”, which states {stated}, {word} its promise: {rate} of motions of held-out "
        "earthquakes contain it (95 % interval {ends}){ending}.",
        name=row["candidate"],
        stated=percent(row["confidence"]),
        word="keeps" if keeps else "does not keep",
        rate=rate,
        ends=ends,
        ending=ending,
    )
    return verdict, keeps


def verdicts_section(verdicts: pd.DataFrame, confidence: float) -> Section:
    """Count good and bad tests that criteria accept and refuse.

    `verdicts`: columns `candidate`, `confidence`, `good_accepted`, `good_rejected`, `bad_accepted`,
    `bad_rejected`; `confidence`: share of the population's ground motions that the criteria state [-].
    """
    rows = verdicts[np.isclose(verdicts["confidence"], confidence)]
    rows = rows.assign(candidate=[law_in_words(str(name)) for name in rows["candidate"]])
    good, bad = prose("good tests"), prose("bad tests")
    return Section(
        title="Verdicts on simulated tests",
        blocks=(
            Table(
                frame=rows,
                columns=(
                    Column(key="candidate", heading="Criterion"),
                    Column(key="good_accepted", heading="accepted", number=Fixed(decimals=0), group=good),
                    Column(key="good_rejected", heading="refused", number=Fixed(decimals=0), group=good),
                    Column(key="bad_accepted", heading="accepted", number=Fixed(decimals=0), group=bad),
                    Column(key="bad_rejected", heading="refused", number=Fixed(decimals=0), group=bad),
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


def actuators_section(tests: pd.DataFrame) -> Section:
    """Report tests whose actuators are no constant gain and delay."""
    return Section(
        title="Actuators that are not a constant gain and delay",
        blocks=(
            prose(
                "Each test was simulated with its actuator; $A$ and $d$ were evaluated from command and "
                "measured displacement as a laboratory would, and the error was compared with that of a "
                "constant gain $A$ and delay $d$ (@fig:beyond, @tab:beyond). The delays lie below "
                "and above what the criterion allows and what the motion of each test tolerates, so that "
                "good and bad tests are accepted or refused as the criterion decides."
            ),
            RpFigure(
                drawing=error_beyond_the_model(tests),
                caption=(
                    "Error of each test over the error that a constant gain and delay would have made: "
                    "on the diagonal, A and d describe the actuator fully."
                ),
                label="fig:beyond",
                floats=True,
            ),
            _actuator_rows(_count_by_actuator(tests)),
        ),
    )


def _count_by_actuator(tests: pd.DataFrame) -> pd.DataFrame:
    """Count verdicts and measure how far the prediction is off, for each actuator."""
    grouped = tests.assign(
        excess=(tests["error"] - tests["predicted"]).abs() / tests["predicted"],
        bad=~tests["good"],
        unsafe=tests["accepted"] & ~tests["good"],
        wasted=~tests["accepted"] & tests["good"],
    ).groupby("rig", sort=False)
    return grouped.agg(
        tests=("error", "size"),
        typical=("excess", "median"),
        worst=("excess", "max"),
        bad=("bad", "sum"),
        accepted=("accepted", "sum"),
        unsafe=("unsafe", "sum"),
        wasted=("wasted", "sum"),
    ).reset_index()


def _actuator_rows(frame: pd.DataFrame) -> Table:
    share, off = Fixed(decimals=1, factor=PERCENT), "off the prediction"
    return Table(
        frame=frame,
        columns=(
            Column(key="rig", heading="Actuator", wide=True),
            Column(key="tests", heading="Tests", number=Fixed(decimals=0)),
            Column(key="typical", heading="median", unit="%", number=share, group=off),
            Column(key="worst", heading="worst", unit="%", number=share, group=off),
            Column(key="bad", heading="Bad", number=Fixed(decimals=0)),
            Column(key="accepted", heading="Accepted", number=Fixed(decimals=0)),
            Column(key="unsafe", heading="Accepted, yet bad", number=Fixed(decimals=0)),
            Column(key="wasted", heading="Good, yet refused", number=Fixed(decimals=0)),
        ),
        caption=(
            "Verdicts on actuators beyond the model; a test is bad when its own simulated error "
            "exceeds the threshold."
        ),
        label="tab:beyond",
    )


_HEIGHT = 76.0
_WIDTH = 120.0


@apply_style
def error_beyond_the_model(
    tests: pd.DataFrame, *, prediction: str = "Error of a constant gain $A$ and delay $d$"
) -> Figure:
    """Draw the error of each test over that of a constant gain and delay with the same indices.

    `tests`: columns rig, error [-] and predicted [-], one row a test. Result: both errors [%] on logarithmic
    scales; on the diagonal they agree.
    """
    figure, axes = panels(height=_HEIGHT, width=_WIDTH)
    place = axes[0, 0]
    percent = PERCENT * tests[["predicted", "error"]]
    ends = (0.8 * float(percent.min().min()), 1.25 * float(percent.max().max()))
    place.plot(ends, ends, color=GREY, linewidth=0.9)
    for rank, (name, errors) in enumerate(percent.groupby(tests["rig"], sort=False)):
        look = {**line(rank, marker=True), "linestyle": "none", "fillstyle": "none"}
        place.plot(errors["predicted"], errors["error"], label=plain(str(name)), **look)
    place.set(xscale="log", yscale="log", xlim=ends, ylim=ends, aspect="equal")
    label_logarithmic(place.xaxis, place.yaxis)
    name_axes(place, f"{prediction} [%]", "Error of the test [%]")
    legend_below(figure, place, columns=2)
    return figure


def cases_section(cases: xr.Dataset) -> Section:
    """Show the verdicts of equation (18) on the four cases, their errors, and what the paper prints."""
    seconds = f"{cases.attrs.get('window', 0.0):g}"
    caption = "Exact response and measured displacement of the four cases."
    return Section(
        title="The four cases of the paper",
        blocks=(
            prose(
                "The application of the paper @guo2017, simulated under {motion}: $A$ and $d$ are those "
                "of command and measured displacement, the index is that of equation (18), and a test "
                'is good while its $"RMS"^R$ is at most 5 %. The error is that over the first '
                "{seconds} s of the record, relative to the peak of the exact response; the last column "
                "gives it relative to the RMS of the exact response (@tab:cases).",
                motion=str(cases.attrs.get("motion", "one motion")),
                seconds=seconds,
            ),
            _case_rows(case_table(cases), seconds),
            case_histories(cases, caption=caption, label="fig:cases"),
        ),
    )


def _case_rows(frame: pd.DataFrame, seconds: str) -> Table:
    number, ratio, good = Fixed(decimals=3), Fixed(factor=PERCENT), prose('$"RMS"^R$')
    simulated, printed, index, verdict = "simulated", "printed", "index of (18)", "index at most 1"
    of_rms = Fixed(decimals=1, factor=PERCENT)
    return Table(
        frame=frame,
        columns=(
            Column(key="case", heading="Case", number=Fixed(decimals=0)),
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
