"""Slips of the paper: in its equations, its tables and its text."""

from typing import Final

import numpy as np
import pandas as pd

from reliab.report.document import Points, Section
from reliab.report.prose import Prose, prose

from ..printed import CLOSE
from ..text import SLIPS

_ALWAYS: Final[tuple[Prose, ...]] = (
    prose(
        "Table 4's column $b$ is $sqrt(b)$ in ms (@fig:paper-table-4). $b$ therefore grows as "
        "$xi^(2.3)$, and so does $a$; equations (16) to (18), linear in $xi$, rest on the misreading. With "
        "squares in their place, fitted over the table, (17) would still allow 1.6 ($a$) and 1.4 ($b$) times "
        "what Table 4 does at $xi = 0.02$, on the unsafe side."
    ),
    prose(
        "Equation (15)'s exponential meets Table 3 at 0.25 Hz only (@fig:paper-15); $b f^2$ is nearly "
        "constant over the table."
    ),
    prose(
        "Equation (18) gives $a = 0.021 xi$, which is $4.2 dot 10^(-4)$ at $xi = 0.02$, where equation "
        "(15) says $5.6 dot 10^(-5)$. Table 6 is nevertheless what (18) gives."
    ),
    prose(
        "The ranges that the text quotes for $a$ and $b$ are not those of Table 2 ($0.45 dot 10^(-4)$ to"
        " $24.5 dot 10^(-4)$ and 0.90 to 47.8 ms²), and the root of its greatest $a$ is "
        "$2.6 dot 10^(-2)$, not $2.3 dot 10^(-2)$. 24 and 28 sets of two components are 104, not 100."
    ),
    prose(
        "The text before equation (18) says 1000$xi$ where 100$xi$ is meant, and 46080$xi$ where "
        "6080$xi$ is meant."
    ),
)
"""Slips of equations and tables that follow from what the paper prints."""


def errata_section(numbers: pd.DataFrame) -> Section:
    """List the slips."""
    slips = tuple(prose("{place}: {slip}", place=place, slip=slip) for place, slip in SLIPS)
    return Section(
        title="Errata of the paper",
        blocks=(
            "Tables and equations are numbered here as in the paper, figures as in this report.",
            Points(items=(*_ALWAYS, *_find_slips(numbers), *slips)),
        ),
        label="sec:errata",
    )


def _find_slips(numbers: pd.DataFrame) -> tuple[Prose, ...]:
    """Slips that the records show."""
    errors = prose(
        "At 6.4 ms the text quotes errors of 280 % and 96 %; the exact loop gives {mte:.0f} % and "
        "{rms:.0f} %.",
        mte=number(numbers, "Figure 4", "MTE^R at 6.4 ms"),
        rms=number(numbers, "Figure 4", "RMS^R at 6.4 ms"),
    )
    peak = number(numbers, "Text above Table 5", "peak acceleration of KOBE/KJM000")
    if not np.isfinite(peak):
        return (errors,)
    return (
        errors,
        prose("The peak of KOBE/KJM000 is {found:.3f} g in the record, 0.707 g in the text.", found=peak),
    )


def name_row_numbers(numbers: pd.DataFrame) -> pd.Series:
    """Tell which numbers are those of a row of Table 2."""
    return (numbers["item"] == "Table 2") & numbers["quantity"].str.contains(" of ")


def count(numbers: pd.DataFrame) -> tuple[int, int]:
    """Count the printed numbers outside of Table 2's rows that are reproduced, and those that can be."""
    compared = numbers[~name_row_numbers(numbers) & (numbers["item"] != "Table 2")].dropna(
        subset=["difference"]
    )
    return int((compared["difference"].abs() <= CLOSE).sum()), len(compared)


def find_agreeing_rows(numbers: pd.DataFrame) -> tuple[int, int, int]:
    """Rows of Table 2 that are reproduced in a and b, those that do in the fitting error, and all rows."""
    both, errors = "rows within 10 % in a and b", "rows within 10 % in the fitting error"
    rows = int(number(numbers, "Table 2", both, "printed"))
    return int(number(numbers, "Table 2", both)), int(number(numbers, "Table 2", errors)), rows


def number(numbers: pd.DataFrame, item: str, quantity: str, column: str = "from_records") -> float:
    """Take one number of the table."""
    rows = (numbers["item"] == item) & (numbers["quantity"] == quantity)
    return float(numbers.loc[rows, column].to_numpy(dtype=np.float64)[0])
