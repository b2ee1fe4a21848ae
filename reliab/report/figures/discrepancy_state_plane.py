"""Residual of a model in a measured channel, over displacement and velocity: a restoring-force surface."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from numpy.typing import NDArray
from scipy.stats import binned_statistic_2d

from reliab.report.axes import name_axes
from reliab.report.style import letters, panels, styled
from reliab.vocabulary import MILLI

_HEIGHT = 66.0
_BINS = 25
_FEWEST = 3  # samples in a field
_REACH = 0.995  # quantile of the motion at which the axes end
_COLOURS = "RdBu_r"


@styled
def discrepancy_state_plane(
    displacement: NDArray[np.float64],
    velocity: NDArray[np.float64],
    before: NDArray[np.float64],
    after: NDArray[np.float64],
    *,
    unit: str,
    factor: float = 1.0,
) -> Figure:
    """Draw mean residuals over the state of the specimen, before and after effects were added.

    `displacement`, `velocity` [m, m/s].
    Returns mean residual over displacement [mm] and velocity [mm/s] on one scale; blank where the tests never
    were.
    """
    figure, axes = panels(1, 2, height=_HEIGHT, share_x=True, share_y=True)
    letters(axes, ("calibrated model", "with the effects"))
    ends = [MILLI * float(np.quantile(np.abs(values), _REACH)) for values in (displacement, velocity)]
    fields = [_field(displacement, velocity, factor * values, ends) for values in (before, after)]
    limit = float(np.nanquantile(np.abs(fields[0]), 0.98)) or 1.0
    for place, field in zip(axes[0], fields, strict=True):
        drawn = _draw(place, field, ends, limit)
        name_axes(place, "Displacement [mm]", "Velocity [mm/s]" if place is axes[0, 0] else "")
    figure.colorbar(drawn, ax=axes[0], label=f"Mean residual [{unit}]", extend="both")
    return figure


def _field(
    displacement: NDArray[np.float64],
    velocity: NDArray[np.float64],
    values: NDArray[np.float64],
    ends: list[float],
) -> NDArray[np.float64]:
    """Mean over fields of the state plane, shape (displacement, velocity)."""
    limits = [[-ends[0], ends[0]], [-ends[1], ends[1]]]
    at = (MILLI * displacement, MILLI * velocity)
    mean, count = (
        binned_statistic_2d(*at, values, statistic, bins=_BINS, range=limits).statistic
        for statistic in ("mean", "count")
    )
    return np.where(count >= _FEWEST, mean, np.nan)


def _draw(place: Axes, field: NDArray[np.float64], ends: list[float], limit: float) -> AxesImage:
    place.grid(visible=False)
    return place.imshow(
        field.T,
        origin="lower",
        aspect="auto",
        extent=(-ends[0], ends[0], -ends[1], ends[1]),
        cmap=_COLOURS,
        vmin=-limit,
        vmax=limit,
        interpolation="nearest",
    )
