"""A criterion that protects tests of every length of its population, where no length is stated.

A criterion of motions as they were recorded holds on average over their lengths: it promises too much for
short records and too little for long ones. Here every third of the lengths is protected. The population is
carried to the middle of each third, and at each structure the least favourable of the three counts.
"""

from typing import Final

import numpy as np
import xarray as xr

from reliab.arrays import Array
from reliab.criterion.carrying import DIMENSIONS, carry_to_length
from reliab.sweep import shares_of
from reliab.vocabulary import CurveName, Metric

_LEAST_MOTIONS: Final = 30  # of a population, below which the dependence on their length is not learned
_LEAST_EARTHQUAKES: Final = 10
_MIDDLES_OF_THIRDS: Final = (1.0 / 6.0, 1.0 / 2.0, 5.0 / 6.0)
_UNFAVOURABLE: Final = 0.05  # quantile of a and b by which lengths are compared
_SAME: Final = 1.01  # ratio of lengths between which nothing is learned


def protect_over_lengths(
    ellipses: xr.Dataset, *, metric: str = Metric.RMS, curve: str = CurveName.INSCRIBED
) -> xr.Dataset:
    """Carry the ellipses of a population to the least favourable of its lengths.

    Parameters
    ----------
    ellipses : xarray.Dataset
        Ellipses of the population.
    metric : str, optional
        Error of the criterion; RMS^R alone depends on the length.
    curve : str, optional
        Ellipses on which the criterion will rest. Those that are fitted to boundaries are the paper's, whose
        criterion is one of motions as they were recorded.

    Returns
    -------
    xarray.Dataset
        For each structure the inscribed ellipses of RMS^R at one of three lengths, the middles of the thirds
        of all; those of other errors and curves stay beside them. The ellipses as they are where nothing can
        be learned of lengths: for a criterion of an error other than RMS^R, windows, a partly numerical
        structure, or fewer than thirty motions of ten earthquakes.

    Examples
    --------
    >>> from reliab.criterion import read_ellipses
    >>> protected = protect_over_lengths(read_ellipses("real_suite"))
    >>> protected.attrs["carried_to"]
    'each structure at the least favourable of 25, 39 and 56 s'
    """
    if metric != Metric.RMS or curve != CurveName.INSCRIBED or not _shows_lengths(ellipses):
        return ellipses
    own = {"metric": [metric], "curve": [curve]}
    lengths = np.quantile(ellipses["duration"].values, _MIDDLES_OF_THIRDS)
    carried = [carry_to_length(ellipses.sel(own), float(length)) for length in lengths]
    protected = ellipses.copy()
    for name in ("a", "b"):
        dimensions = ellipses[name].dims
        values = np.stack([at_length[name].transpose(*dimensions).values for at_length in carried])
        protected[name] = ellipses[name].astype(values.dtype)
        protected[name].loc[own] = _least_favourable(values, 1 + dimensions.index("motion"))
    first, second, third = (f"{length:.0f}" for length in lengths)
    words = f"each structure at the least favourable of {first}, {second} and {third} s"
    return protected.assign_attrs(carried_to=words, position="inside", caution="")


def _least_favourable(values: Array, motions: int) -> Array:
    """Values (lengths, ...) at the length of the least quantile over the motions; NaN counts as large."""
    large = np.where(np.isfinite(values), values, np.inf)
    low = np.quantile(large, _UNFAVOURABLE, axis=motions, keepdims=True, method="lower")
    least = np.broadcast_to(low.argmin(axis=0)[None], (1, *values.shape[1:]))
    return np.asarray(np.take_along_axis(values, least, axis=0)[0])


def _shows_lengths(ellipses: xr.Dataset) -> bool:
    """Whether the population is large enough, and its errors such, that lengths tell something of limits."""
    if "duration" not in ellipses.coords or "carried_to" in ellipses.attrs:
        return False
    lengths = ellipses["duration"].values
    return (
        set(ellipses["a"].dims) == set(DIMENSIONS)
        and Metric.RMS in ellipses["metric"].values
        and CurveName.INSCRIBED in ellipses["curve"].values
        and str(ellipses.attrs.get("window", "record")) == "record"
        and shares_of(ellipses) == (1.0,)
        and lengths.size >= _LEAST_MOTIONS
        and np.unique(ellipses["event"].values).size >= _LEAST_EARTHQUAKES
        and bool(lengths.max() > _SAME * lengths.min())
    )
