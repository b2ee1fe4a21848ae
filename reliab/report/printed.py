"""The tables of Guo and others (2017) as printed, read from what ships with the project."""

from dataclasses import dataclass

import pandas as pd

from reliab.shipped import shipped


@dataclass(frozen=True, kw_only=True, eq=False)
class PrintedTables:
    """Printed numbers, in the columns of the shipped files.

    Attributes
    ----------
    motions : pandas.DataFrame
        Table 2: no, record, a, b [ms²], error [ms⁴].
    frequencies : pandas.DataFrame
        Table 3: f_hz, a, b [ms²].
    damping_ratios : pandas.DataFrame
        Table 4: xi, a, b (which is √b [ms]).
    cases : pandas.DataFrame
        Tables 5 and 6.
    """

    motions: pd.DataFrame
    frequencies: pd.DataFrame
    damping_ratios: pd.DataFrame
    cases: pd.DataFrame


def printed_tables() -> PrintedTables:
    """Read the printed tables.

    Returns
    -------
    PrintedTables
        The tables.

    Examples
    --------
    >>> tables = printed_tables()
    >>> len(tables.motions), len(tables.frequencies), len(tables.damping_ratios), len(tables.cases)
    (100, 8, 9, 4)
    """
    names = {"motions": "table2", "frequencies": "table3", "damping_ratios": "table4", "cases": "tables5_6"}
    return PrintedTables(
        **{field: pd.read_csv(shipped("datasets", f"paper/{name}.csv")) for field, name in names.items()}
    )
