"""Every table, figure and numbered equation of the paper: printed, reproduced, difference."""

import pandas as pd
import xarray as xr

from reliab.report.kinds.comparison import Comparison
from reliab.report.kinds.paper_compared_equations import compare_equations
from reliab.report.kinds.paper_compared_figures import compare_figures
from reliab.report.kinds.paper_compared_tables import (
    compare_table_1,
    compare_table_2,
    compare_table_3,
    compare_table_4,
    compare_tables_5_6,
)
from reliab.report.kinds.paper_fits import PaperFits
from reliab.report.printed import PrintedTables


def comparisons(fits: PaperFits, cases: xr.Dataset, printed: PrintedTables) -> pd.DataFrame:
    """Compare all numbers that the paper prints with what was found.

    Parameters
    ----------
    fits : PaperFits
        The paper's steps on simulated ellipses.
    cases : xarray.Dataset
        As :func:`reliab.report.kinds.paper_cases.cases_dataset` makes it.
    printed : PrintedTables
        The printed tables.

    Returns
    -------
    pandas.DataFrame
        Columns item, quantity, unit, printed, reproduced, difference (reproduced over printed minus
        one [-]) and remark; tables, figures and equations in the order of their numbers.
    """
    found = [
        *compare_table_1(fits),
        *compare_table_2(fits, printed),
        *compare_table_3(fits, printed),
        *compare_table_4(fits, printed),
        *compare_tables_5_6(cases, printed),
        *compare_figures(fits, cases, printed),
        *compare_equations(fits, cases, printed),
    ]
    frame = pd.DataFrame([vars(each) for each in sorted(found, key=_place)])
    return frame.assign(difference=frame["reproduced"] / frame["printed"] - 1.0)


def _place(comparison: Comparison) -> tuple[int, int]:
    """Place of an item: tables, figures, equations, each by number; letters keep their order."""
    kind, number = comparison.item.split()
    return ("Table", "Figure", "Equation").index(kind), int("".join(filter(str.isdigit, number)))
