"""Report of a run whose motions are too few for a criterion: what they do show, and what is missing."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from reliab.report.document import Column, Document, Points, Section, Table
from reliab.report.numbers import Fixed, Number, Scientific, Significant
from reliab.report.prose import Prose, prose
from reliab.report.provenance import provenance_of
from reliab.vocabulary import PERCENT


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
            Section(title="What each motion tolerates", blocks=(_table(ellipses),)),
        ),
        provenance=provenance_of(provenance),
    )


def _table(ellipses: xr.Dataset) -> Table:
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
