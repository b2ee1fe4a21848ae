"""Report of a validation: whether criteria keep their promise on motions they have not seen."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from reliab.report import SOURCES, Block, Document, Prose, provenance_of
from reliab.report.prose import prose
from reliab.report.sections import limits_section, method_section, rates_section
from reliab.significant import percent

from ..pages.actuators import actuators_section
from ..pages.cases import cases_section
from ..pages.rebuilt_error import rebuilt_error_section
from ..pages.verdicts import verdicts_section

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
    :func:`reliab.validation.cross_validation.counts.tabulate` makes it; `threshold`: error up to which these
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
        sources=SOURCES,
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
