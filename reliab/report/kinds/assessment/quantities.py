"""Tables of an assessed test: one quantity in a row, its numbers written out."""

from collections.abc import Sequence

import pandas as pd

from reliab.report.document import Column, Table
from reliab.report.prose import Prose


def quantities_table(
    rows: Sequence[tuple[str, ...]], headings: Sequence[str], *, caption: Prose, label: str
) -> Table:
    """Tabulate quantities."""
    frame = pd.DataFrame(rows, columns=[str(place) for place in range(len(headings))])
    return Table(
        frame=frame,
        columns=tuple(
            Column(key=key, heading=heading, wide=key == "0")
            for key, heading in zip(frame.columns, headings, strict=True)
        ),
        caption=caption,
        label=label,
    )
