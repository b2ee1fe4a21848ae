"""Ellipse parameters over frequency (Figures 14 and 15) and over damping ratio (Table 4)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.report.axes import (
    A_PARAMETER,
    B_PARAMETER,
    DAMPING_RATIO,
    FREQUENCY,
    label_logarithmic,
    legend_below,
    name_axes,
    plain,
)
from reliab.report.style import letters, line, panels, styled

_HEIGHT = 58.0


@dataclass(frozen=True, kw_only=True, eq=False)
class ParameterSeries:
    """Ellipse parameters of one source over one property of the structure."""

    name: str  # Source
    x: NDArray[np.float64]  # Natural frequencies [Hz] or damping ratios [-], shape (n,)
    a: NDArray[np.float64]  # a, b: Parameters [-] and [ms²], shape (n,)
    b: NDArray[np.float64]
    law: bool = False  # Whether it is a law, drawn as a line, rather than values, drawn as points


@styled
def parameters_over_frequency(series: Sequence[ParameterSeries]) -> Figure:
    """Draw a and b over the natural frequency, b on a logarithmic scale."""
    return _draw(series, FREQUENCY, logarithmic=False)


@styled
def parameters_over_damping_ratio(series: Sequence[ParameterSeries]) -> Figure:
    """Draw a and b over the damping ratio on logarithmic scales, on which a power law is straight."""
    return _draw(series, DAMPING_RATIO, logarithmic=True)


def _draw(series: Sequence[ParameterSeries], name: str, *, logarithmic: bool) -> Figure:
    figure, axes = panels(1, 2, height=_HEIGHT)
    letters(axes, ("$a$", "$b$"))
    for rank, member in enumerate(series):
        look = line(rank, marker=not member.law)
        if not member.law:
            look |= {"linestyle": "none", "fillstyle": "none"}
        for place, values in zip(axes[0], (member.a, member.b), strict=True):
            place.plot(member.x, values, label=plain(member.name), **look)
    for place, parameter in zip(axes[0], (A_PARAMETER, B_PARAMETER), strict=True):
        name_axes(place, name, parameter)
        place.set_yscale("log")
        if logarithmic:
            place.set_xscale("log")
            label_logarithmic(place.xaxis)
        label_logarithmic(place.yaxis)
    legend_below(figure, axes[0, 0], columns=4)
    return figure
