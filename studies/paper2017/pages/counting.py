"""Rows of the table of the paper's numbers, and how many of them agree."""

import numpy as np
import pandas as pd

from ..item import CLOSE


def of_row(numbers: pd.DataFrame) -> pd.Series:
    """Tell which numbers are those of a row of Table 2."""
    return (numbers["item"] == "Table 2") & numbers["quantity"].str.contains(" of ")


def count(numbers: pd.DataFrame) -> tuple[int, int]:
    """How many printed numbers outside the rows of Table 2 come back, of how many that can be recomputed."""
    compared = numbers[~of_row(numbers) & (numbers["item"] != "Table 2")].dropna(subset=["difference"])
    return int((compared["difference"].abs() <= CLOSE).sum()), len(compared)


def rows_that_agree(numbers: pd.DataFrame) -> tuple[int, int, int]:
    """Rows of Table 2 that come back in a and b, those that do in the fitting error, and all rows."""
    both, errors = "rows within 10 % in a and b", "rows within 10 % in the fitting error"
    rows = int(number(numbers, "Table 2", both, "printed"))
    return int(number(numbers, "Table 2", both)), int(number(numbers, "Table 2", errors)), rows


def number(numbers: pd.DataFrame, item: str, quantity: str, column: str = "from_records") -> float:
    """Take one number of the table."""
    rows = (numbers["item"] == item) & (numbers["quantity"] == quantity)
    return float(numbers.loc[rows, column].to_numpy(dtype=np.float64)[0])
