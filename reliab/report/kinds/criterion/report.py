"""Report of a criterion: verdict, result, motions and method; or, of too few motions, what they do show."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from reliab.core.significant_digits import percent, percent_range, share_in_words
from reliab.core.vocabulary import PERCENT, Metric
from reliab.criterion.criterion import Criterion
from reliab.report.document import Block, Column, Document, Points, Section, Table
from reliab.report.kinds.criterion.motions import appendix_section, motions_section
from reliab.report.kinds.criterion.reported import ReportedCriteria
from reliab.report.kinds.criterion.result import result_section
from reliab.report.numbers import Fixed, Number, Scientific, Significant
from reliab.report.prose import Prose, prose
from reliab.report.provenance import provenance_of
from reliab.report.sections.method import limits_section, method_section
from reliab.report.sections.rates import rates_section
from reliab.report.sources import SOURCES
from reliab.report.wording import (
    MEANINGS_OF_ERRORS,
    ellipse,
    error_below,
    meaning_of_confidence,
    values,
    window_in_words,
)
from reliab.sweep.shares import share_of

_NEXT = (
    "judge a test with reliab assess TEST.csv --criterion FILE.json: it takes the index of the test from its "
    "command and measured displacement, and also states the error of the test itself"
)


def criterion_report(
    *,
    title: str,
    ellipses: xr.Dataset,
    criteria: Sequence[Criterion],
    coverage: pd.DataFrame | None = None,
    population: str = "ground motions",
    real_motions: Mapping[str, float] | None = None,
    provenance: Mapping[str, object],
    notes: Sequence[Prose] = (),
    purpose: str = "",
) -> Document:
    """Report criteria and the motions behind them.

    `real_motions` [-].
    """
    reported = ReportedCriteria(ellipses=ellipses, criteria=tuple(criteria))
    criterion = reported.criterion
    fraction = share_of(ellipses)
    blocks: list[Block] = [result_section(reported, population), motions_section(reported)]
    if coverage is not None and len(coverage):
        blocks.append(rates_section(coverage, confidence=criterion.confidence))
    blocks += [
        limits_section((*criterion.provenance.warnings, *notes)),
        method_section(criterion, experimental_fraction=fraction, window=criterion.provenance.window),
        appendix_section(reported),
    ]
    return Document(
        kind="Reliability criterion",
        title=title,
        verdict=_verdict(reported, population),
        facts={
            **_facts(reported, coverage),
            **_real(real_motions),
            "Purpose": purpose,
            "To do next": _NEXT,
        },
        blocks=tuple(blocks),
        provenance=provenance_of(provenance, criterion.provenance),
        sources=SOURCES,
    )


def _verdict(reported: ReportedCriteria, population: str) -> Prose:
    criterion, (f, xi), (a, b) = reported.criterion, reported.structure, reported.limits
    early = reported.lead(criterion)
    return (
        *prose("At {f:g} Hz and $xi = {xi:g}$, a test keeps ", f=f, xi=xi),
        *error_below(criterion.metric, criterion.threshold),
        f" for {share_in_words(criterion.promise)} of {population} like those behind it while ",
        ellipse(a, b),
        *prose(
            " with $d$ in ms: at most {amplitude} of amplitude error alone, or {delay:.2f} ms of delay alone"
            "{lead}.",
            amplitude=percent(np.sqrt(a), 2),
            delay=np.sqrt(b),
            lead=f", or a lead of {early:.2f} ms alone" if np.isfinite(early) else "",
        ),
    )


def _real(share: Mapping[str, float] | None) -> dict[str, Prose]:
    """Say how many real motions contain a criterion that was derived from others."""
    if share is None:
        return {}
    sentence = (
        f"{percent(share['rate'], decimals=1)} of {share['n_motions']:g} real motions of "
        f"{share['n_events']:g} other earthquakes contain this criterion by their simulated errors "
        f"(95 % interval {percent_range(share['low'], share['high'], decimals=1)})"
    )
    return {"On real motions": sentence}


def _facts(reported: ReportedCriteria, coverage: pd.DataFrame | None) -> dict[str, Prose]:
    criterion, source = reported.criterion, reported.criterion.provenance
    together = "for both limits together" if criterion.joint else "for each limit separately"
    meaning = meaning_of_confidence(criterion.method)
    facts: dict[str, Prose] = {
        "Ground motions": source.population or f"{source.n_motions} of {source.n_events} earthquakes",
        "Structures": prose(
            "$f$ = {f}, $xi$ = {xi}, $alpha$ = {alpha:g} of the stiffness in the laboratory",
            f=values(reported.frequencies.tolist(), "Hz"),
            xi=values(reported.damping_ratios.tolist()),
            alpha=source.experimental_fraction,
        ),
        "Error": (
            *error_below(criterion.metric, criterion.threshold),
            f", {MEANINGS_OF_ERRORS[Metric(criterion.metric)]}, over {window_in_words(source.window)}",
        ),
        "Confidence": f"{share_in_words(criterion.promise)}, {together}: {meaning}",
    }
    if coverage is not None and len(coverage):
        facts["Put to the test"] = _tested(coverage, criterion.confidence)
    return facts


def _tested(coverage: pd.DataFrame, confidence: float) -> Prose:
    overall = coverage[coverage["f"].isna() & np.isclose(coverage["confidence"], confidence)]
    if overall.empty:
        return prose("see @sec:coverage")
    row = overall.iloc[0]
    return (
        f"{percent(row['rate'], decimals=1)} of the motions of held-out earthquakes contain the criterion "
        f"(95 % interval {percent_range(row['low'], row['high'], decimals=1)})"
    )


def no_criterion_report(
    *,
    title: str,
    ellipses: xr.Dataset,
    reasons: Sequence[str],
    provenance: Mapping[str, object],
    purpose: str = "",
) -> Document:
    """Report the boundaries of the motions, and why no criterion follows from them."""
    events = len(set(ellipses["event"].values.tolist()))
    motions = ellipses.sizes["motion"]
    return Document(
        kind="Reliability criterion",
        title=title,
        verdict=f"{motions} ground motions of {events} earthquakes are too few for the criteria asked for.",
        tone="bad",
        facts={"Ground motions": f"{motions} of {events} earthquakes", "Purpose": purpose},
        blocks=(
            Section(title="What could not be done", blocks=(Points(items=tuple(reasons)),)),
            Section(title="What each motion tolerates", blocks=(_ellipses_table(ellipses),)),
        ),
        provenance=provenance_of(provenance),
    )


def _ellipses_table(ellipses: xr.Dataset) -> Table:
    first = {name: 0 for name in ellipses["a"].dims if name != "motion"}
    at = ellipses.isel(first)
    f, xi, threshold = (float(at[name]) for name in ("f", "xi", "threshold"))
    frame = at[["a", "b"]].reset_coords("event").to_dataframe().reset_index()
    positive = frame[["a", "b"]].where(frame[["a", "b"]] > 0.0)
    frame = frame.assign(amplitude=np.sqrt(positive["a"]), delay=np.sqrt(positive["b"]))
    columns: tuple[tuple[str, Prose, str, Number], ...] = (
        ("a", prose("$a$"), "-", Scientific()),
        ("b", prose("$b$"), "ms²", Significant()),
        ("amplitude", prose("$sqrt(a)$"), "%", Fixed(factor=PERCENT)),
        ("delay", prose("$sqrt(b)$"), "ms", Fixed()),
    )
    return Table(
        frame=frame,
        columns=(
            Column(key="motion", heading="Motion"),
            Column(key="event", heading="Earthquake"),
            *(
                Column(key=key, heading=heading, unit=unit, number=number)
                for key, heading, unit, number in columns
            ),
        ),
        caption=prose(
            "Ellipses fitted to the boundaries of the motions at {f:g} Hz, $xi = {xi:g}$ and an error of "
            "{threshold:g} %.",
            f=f,
            xi=xi,
            threshold=PERCENT * threshold,
        ),
        label="tab:motions",
    )
