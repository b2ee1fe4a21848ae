"""The audit: all items in one table."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pandas as pd
import xarray as xr

from reliab.errors import InputError
from reliab.paper.all_structures import equation_18, table_5, table_6
from reliab.paper.item import AuditItem
from reliab.paper.many_motions import equation_12, equation_15, figures_11_12, table_2, table_3
from reliab.paper.one_motion import equation_14, equations_16_17, table_1, table_4
from reliab.paper.printed import Printed, Recomputed


def audit(
    folder: Path,
    ellipses: xr.Dataset | None = None,
    *,
    simulated: Mapping[tuple[str, str], float] | None = None,
) -> pd.DataFrame:
    """Recompute every number of Tables 1 to 6 and equations (11) to (18).

    Parameters
    ----------
    folder : Path
        The printed tables, `datasets/paper` of this project.
    ellipses : xarray.Dataset, optional
        Ellipses of the 100 records over f, ξ, threshold and metric, motions named as in Table 2; columns
        that need them are NaN without.
    simulated : mapping of (item, quantity) to float, optional
        What only a simulation of a test can give, under the names of the table's first two columns:
        the cosine and parabola of Table 1, A, d [ms] and RMS^R [%] of Table 6.

    Returns
    -------
    pandas.DataFrame
        Columns item, quantity, unit, printed, from_tables, from_records, difference (relative; of the
        records, or else of the tables) and finding.

    Raises
    ------
    InputError
        If a table is missing, or `simulated` names something that the paper does not print.

    Examples
    --------
    >>> from reliab.shipped import shipped
    >>> table = audit(shipped("datasets", "paper")).set_index(["item", "quantity"])
    >>> table.loc[("Equation (12)", "a"), "from_tables"].round(7)
    np.float64(5.29e-05)
    >>> table.loc[("Equation (16)", "k4"), "finding"]
    'the slope of √b [ms] printed as that of b; b grows with ξ²'
    """
    printed, records = Printed.read(folder), Recomputed(ellipses=ellipses)
    items = [
        *table_1(printed, records),
        *table_2(printed, records),
        *figures_11_12(printed, records),
        *equation_12(printed, records),
        *equation_14(printed, records),
        *table_3(printed, records),
        *equation_15(printed, records),
        *table_4(printed, records),
        *equations_16_17(printed, records),
        *equation_18(printed),
        *table_5(printed),
        *table_6(printed),
    ]
    return _table(_filled(items, dict(simulated or {})))


def _filled(items: list[AuditItem], simulated: dict[tuple[str, str], float]) -> list[AuditItem]:
    unknown = set(simulated) - {(each.item, each.quantity) for each in items}
    if unknown:
        raise InputError(
            "Simulated numbers must belong to an item of the audit",
            value=", ".join(": ".join(each) for each in sorted(unknown)),
            remedy="Use the names of the columns item and quantity",
        )
    return [
        replace(each, from_records=simulated[each.item, each.quantity])
        if (each.item, each.quantity) in simulated
        else each
        for each in items
    ]


def _table(items: list[AuditItem]) -> pd.DataFrame:
    columns = ("item", "quantity", "unit", "printed", "from_tables", "from_records", "difference", "finding")
    return pd.DataFrame([{name: getattr(each, name) for name in columns} for each in items])
