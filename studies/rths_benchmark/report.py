"""Report of the virtual hybrid-simulation benchmark."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from reliab_studies.laboratory.wording import count_good_tests

from reliab.core.significant_digits import counted, percent
from reliab.core.vocabulary import PERCENT
from reliab.report.document import Block, Column, Document, Figure as RpFigure, Section, Table, provenance_of
from reliab.report.numbers import Fixed
from reliab.report.prose import Prose, prose, spell_out
from reliab.report.style import apply_style, label_logarithmic, legend_below, line, name_axes, panels, plain

from .outcomes import NOMINAL, summary

_CRITERIA = tuple(f"J{number}" for number in range(1, 10))
_NAMES = {
    "pi_phase_lead": "PI with phase lead",
    "none": "none",
    "inverse": "third-order inverse",
    "adaptive_time_series": "adaptive time series",
    "adaptive_model_based": "adaptive model-based",
}


def rths_benchmark_report(
    *,
    title: str,
    tests: Sequence[Mapping[str, Any]],
    published: pd.DataFrame | None,
    threshold: float,
    provenance: Mapping[str, object],
    purpose: str = "",
) -> Document:
    """Report the benchmark.

    `threshold`: error up to which a test is good [-].
    """
    rows = [dict(test) for test in tests]
    table, judged = summary(rows), _list_errors(rows)
    blocks: list[Block] = [_compensators(table, rows)]
    if published is not None:
        blocks.append(_report_published(published))
    blocks.append(_errors(judged, threshold))
    return Document(
        kind="Virtual hybrid-simulation benchmark",
        title=title,
        verdict=_verdict(judged, threshold),
        facts={
            "Question": prose(
                "Which compensator keeps the error of a test below {threshold}, and does the error that is "
                "rebuilt from a test alone agree with the true one?",
                threshold=percent(threshold),
            ),
            "Tests": prose(
                "{tests} of cases {cases} under {motions}; {lost}",
                tests=len(rows),
                cases=", ".join(str(case) for case in dict.fromkeys(row["case"] for row in rows)),
                motions=", ".join(dict.fromkeys(str(row["motion"]) for row in rows)),
                lost=_count_lost_tests(int(table["lost"].sum())),
            ),
            "Purpose": purpose,
        },
        blocks=tuple(blocks),
        provenance=provenance_of(provenance),
    )


def _list_errors(rows: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Errors of the tests of the nominal plant, as they are and as they are rebuilt from the test alone."""
    return pd.DataFrame(
        [
            {
                "name": _put_in_words(row["compensator"]),
                "case": row["case"],
                "motion": row["motion"],
                "rms": row["error"]["rms"],
                "rebuilt": row["rebuilt"]["rms"]["value"],
                "low": row["rebuilt"]["rms"]["low"],
                "high": row["rebuilt"]["rms"]["high"],
                "verdict": spell_out(row["rebuilt"]["verdict"]),
            }
            for row in rows
            if row["plant"] == NOMINAL and not row["lost"]
        ],
        columns=["name", "case", "motion", "rms", "rebuilt", "low", "high", "verdict"],
    )


def _verdict(judged: pd.DataFrame, threshold: float) -> Prose:
    """Answer the question of the report with the tests of the nominal plant."""
    if judged.empty:
        return "No test of the nominal plant was kept."
    good = judged["rms"] <= threshold
    off = float((judged["rebuilt"] / judged["rms"] - 1.0).abs().max())
    agree = int(((judged["rebuilt"] <= threshold) == good).sum())
    return prose(
        "The error of the nominal plant stays below {threshold} {kept}. The error rebuilt from a test alone "
        "differs from the true one by at most {off}, and is on the same side of {threshold} in {agree} of "
        "{tests}.",
        threshold=percent(threshold),
        kept=count_good_tests(good.set_axis(judged["name"])),
        off=percent(off, 2),
        agree=agree,
        tests=counted(len(judged), "test"),
    )


def _count_lost_tests(count: int) -> str:
    """Say how many tests were lost, and what that means."""
    meaning = "a piston that moved more than ten times as far as the reference"
    if count == 0:
        return f"none was lost to {meaning}"
    return f"{count} {'was' if count == 1 else 'were'} lost to {meaning}"


def _put_in_words(name: str) -> str:
    return _NAMES.get(name, spell_out(name))


def _report_published(published: pd.DataFrame) -> Section:
    emulated = published[published["variant"] == "emulated"]
    exact = published[published["variant"] == "exact"]
    both = emulated.merge(exact, on=["case", "criterion"], suffixes=("", "_exact"))
    headings = {"published": "printed", "mean": "ours", "mean_exact": "exact"}
    frame = both.pivot_table(index="criterion", columns="case", values=list(headings), sort=False)
    frame.columns = pd.Index([" ".join(map(str, name)) for name in frame.columns.to_flat_index()])
    reached = int(emulated["reached"].sum())
    furthest = {
        variant: float((rows["mean"] / rows["published"] - 1.0).abs().max())
        for variant, rows in published.groupby("variant")
    }
    columns = (
        Column(key="criterion", heading=""),
        *(
            Column(key=f"{key} {case}", heading=heading, number=Fixed(decimals=1), group=f"case {case}")
            for case in both["case"].unique()
            for key, heading in headings.items()
        ),
    )
    text = prose(
        "El Centro scaled by 0.4, PI control with phase lead, nominal plant. {reached} of {cells} printed "
        "digits are reached with at least one noise history when the block diagram's difference blocks are "
        "emulated (“ours”); means over the noises lie within {emulated} of the printed numbers, and within "
        "{exact} when all is solved exactly.",
        reached=reached,
        cells=len(emulated),
        emulated=percent(furthest["emulated"], 1),
        exact=percent(furthest["exact"], 1),
    )
    caption = (
        "The benchmark's Table 3 compared with means over noise histories; J1 in ms, the others in %, in "
        "the order of its code."
    )
    return Section(
        title="The published table",
        blocks=(
            text,
            Table(frame=frame.reset_index(), columns=columns, caption=caption, label="tab:three"),
        ),
    )


def _compensators(table: pd.DataFrame, rows: Sequence[Mapping[str, Any]]) -> Section:
    frame = table.assign(
        name=[_put_in_words(name) for name in table["compensator"]], share=table["lost"] / table["tests"]
    )
    columns = (
        Column(key="name", heading="Compensator", wide=True),
        Column(key="plants", heading="Plants"),
        Column(key="tests", heading="Tests", number=Fixed(decimals=0)),
        Column(key="share", heading="Lost", unit="%", number=Fixed(decimals=1, factor=PERCENT)),
        Column(key="over_force_limit", heading="Over 8.9 kN", number=Fixed(decimals=0)),
        Column(key="J1", heading="J1", unit="ms", number=Fixed(decimals=2)),
        *(
            Column(key=name, heading=name, unit="%", number=Fixed(decimals=1))
            for name in _CRITERIA
            if name in {"J2", "J4", "J6"}
        ),
        Column(key="A", heading="A", number=Fixed(decimals=4)),
        Column(key="d_ms", heading="d", unit="ms", number=Fixed(decimals=2)),
    )
    caption = (
        "Means over cases, motions and plants of the tests that were not lost. J2 is the RMS of tracking, "
        "J4 of the measured first floor and J6 of the second floor against the undivided structure."
    )
    completed = [{**row, "name": _put_in_words(str(row["compensator"]))} for row in rows if not row["lost"]]
    blocks: list[Block] = [Table(frame=frame, columns=columns, caption=caption, label="tab:compensators")]
    if completed:
        drawing = benchmark_spread(pd.DataFrame(completed))
        text = (
            "First floor against the undivided structure (J4), a mark for each test. Look for compensators "
            "that stay low whatever the plant."
        )
        blocks.append(RpFigure(drawing=drawing, caption=text, label="fig:spread", leads=True))
    return Section(title="Compensators", blocks=tuple(blocks))


def _errors(judged: pd.DataFrame, threshold: float) -> Section:
    number = Fixed(decimals=2, factor=PERCENT)
    columns = (
        Column(key="name", heading="Compensator", wide=True),
        Column(key="case", heading="Case", number=Fixed(decimals=0)),
        Column(key="motion", heading="Motion"),
        Column(key="rms", heading="True", unit="%", number=number),
        *(
            Column(key=key, heading=heading, unit="%", number=number, group="Rebuilt from the test")
            for key, heading in (("rebuilt", "Value"), ("low", "From"), ("high", "To"))
        ),
        Column(key="verdict", heading=f"Verdict at {percent(threshold)}"),
    )
    caption = (
        "RMS error of the piston over the peak of the reference, with the 90 % interval that the test's own "
        "command and measured displacement give; nominal plant."
    )
    return Section(
        title="The error of each test",
        blocks=(Table(frame=judged, columns=columns, caption=caption, label="tab:errors"),),
        appendix=True,
    )


_HEIGHT = 105.0
_WIDTH = 150.0
_SPREAD = 0.16


@apply_style
def benchmark_spread(tests: pd.DataFrame) -> Figure:
    """Draw J4 of every test over the case, one mark for each compensator.

    `tests`: columns `name`, `case` and `J4` [%], one row a test. Result: J4 [%] on a logarithmic scale.
    """
    figure, axes = panels(height=_HEIGHT, width=_WIDTH)
    place = axes[0, 0]
    groups = list(tests.groupby("name", sort=False))
    for rank, (name, errors) in enumerate(groups):
        shift = _SPREAD * (rank - 0.5 * (len(groups) - 1))
        look = {**line(rank, marker=True), "linestyle": "none", "fillstyle": "none"}
        place.plot(errors["case"] + shift, errors["J4"].astype(float), label=plain(str(name)), **look)
    cases = np.unique(tests["case"])
    values = tests["J4"].astype(float)
    place.set(xticks=cases, yscale="log", ylim=(0.8 * values.min(), 1.25 * values.max()))
    label_logarithmic(place.yaxis)
    name_axes(place, "Case of the benchmark [-]", "Error of the first floor, J4 [%]")
    legend_below(figure, place, columns=2)
    return figure
