"""The rates of a cross-validation as a table: what commands print and reports show."""

from collections.abc import Sequence
from typing import Final

import pandas as pd
import xarray as xr

from reliab.validation.cross_validation.counts import CrossValidation
from reliab.vocabulary import Side

RATES: Final = ("containment", "containment_by_ellipse", "false_safe", "accepted_share")
"""Rates of a cross-validation, each a method of :class:`CrossValidation`."""


def tabulate(
    validation: CrossValidation, over: Sequence[str] = ("f", "xi"), *, side: Side = Side.LAG
) -> pd.DataFrame:
    """Tabulate the rates of a cross-validation.

    Returns one row for each candidate, confidence and structure that was judged, in this order: each of
    `RATES` [-] with `_low` and `_high` ends of its 95 % interval (NaN where there is nothing to count), and
    the confusion matrix `good_accepted`, `good_rejected`, `bad_accepted`, `bad_rejected` [trials].
    """
    rates = [
        getattr(validation, name)(over, side).rename(
            {"rate": name, "low": f"{name}_low", "high": f"{name}_high"}
        )
        for name in RATES
    ]
    merged = xr.merge([*rates, validation.confusion((*over, "motion"), side)])
    table = merged.to_dataframe(dim_order=merged[RATES[0]].dims).reset_index()
    return table.dropna(subset=RATES[0]).reset_index(drop=True)
