"""Histories of the paper's four cases."""

import xarray as xr

from reliab.report import Figure, Prose
from reliab.vocabulary import PERCENT

from ..pages.displacement_histories import HistoryPanel, displacement_histories


def case_histories(cases: xr.Dataset, *, caption: Prose, label: str, errors: bool = False) -> Figure:
    """Draw the exact response and the measured displacement of each case."""
    panels = [
        HistoryPanel(
            title=f"case {number}",
            times=cases["time"].values,
            ideal=cases["ideal"].sel(case=number).values,
            measured=cases["measured"].sel(case=number).values,
            note=f"RMS error {PERCENT * float(cases['rms'].sel(case=number)):.2f} %" if errors else "",
        )
        for number in cases["case"].values.tolist()
    ]
    return Figure(drawing=displacement_histories(panels), caption=caption, label=label)
