"""The audit: every number of the paper in one table."""

from pathlib import Path

import pandas as pd
import xarray as xr

from .all_structures import equation_18, figure_17, table_5, table_6
from .many_motions import (
    equation_12,
    equation_15,
    figure_11,
    figure_12,
    ranges_of_table_2,
    rows_of_table_2,
    table_2,
    table_3,
)
from .one_motion import definitions, equation_14, equations_16_17, figures_2_to_9, table_1, table_4
from .printed import Item, PrintedTables
from .records import Records
from .text import numbers_of_text

_KINDS = ("Table", "Figure", "Equation", "Text")
_COLUMNS = (
    "item",
    "quantity",
    "unit",
    "printed",
    "from_tables",
    "from_records",
    "difference",
    "finding",
)


def audit(
    folder: Path | None = None,
    ellipses: xr.Dataset | None = None,
    *,
    example: xr.Dataset | None = None,
    cases: xr.Dataset | None = None,
) -> pd.DataFrame:
    """Recompute everything that the paper prints with a number.

    Columns item, quantity, unit, printed, from_tables, from_records, difference (relative; of the records, or
    else of the tables) and finding; tables, figures, equations, then the text.

    >>> table = audit().set_index(["item", "quantity"])
    >>> table.loc[("Equation (12)", "a"), "from_tables"].round(7)
    np.float64(5.29e-05)
    >>> table.loc[("Equation (16b)", "k4"), "finding"]
    'the slope of √b [ms] printed as that of b; b grows with ξ^2.3'
    """
    records = Records(ellipses=ellipses, example=example, cases=cases)
    return tabulate(items_of(PrintedTables.read(folder), records))


def items_of(printed: PrintedTables, records: Records) -> list[Item]:
    """Every number of the paper, in the order of its tables, figures, equations and text."""
    items = (
        *table_1(printed, records),
        *rows_of_table_2(printed, records),
        *table_2(printed, records),
        *table_3(printed, records),
        *table_4(printed, records),
        *table_5(printed, records),
        *table_6(printed, records),
        *definitions(),
        *figures_2_to_9(records),
        *figure_11(printed, records),
        *ranges_of_table_2(printed, records),
        *figure_12(printed, records),
        *equation_14(records),
        *equation_15(printed, records),
        *figure_17(records),
        *equation_12(printed, records),
        *equations_16_17(printed, records),
        *equation_18(),
        *numbers_of_text(printed),
    )
    return sorted(items, key=_place)


def tabulate(items: list[Item]) -> pd.DataFrame:
    """Items as a table, one row for each."""
    return pd.DataFrame([{name: getattr(item, name) for name in _COLUMNS} for item in items])


def _place(item: Item) -> tuple[int, int, str]:
    """Place of an item: tables, figures, equations by number, then the text; letters keep their order."""
    kind, _, rest = item.item.partition(" ")
    number = 0 if kind == "Text" else int("".join(filter(str.isdigit, rest)))
    return _KINDS.index(kind), number, rest
