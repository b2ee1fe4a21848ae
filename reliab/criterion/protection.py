"""A criterion that protects tests of every length of its population, where no length is stated.

A criterion of motions as they were recorded holds on average over their lengths: it promises too much for
short records and too little for long ones. From a share of 90 % on every third of the lengths is protected:
the population is carried to the middle of each third, and at each structure the least favourable of the three
counts. Smaller shares cannot be kept at every length by one pair of limits, since lengths then move them by
more than what is left to protect: they are those of all lengths together.
"""

from dataclasses import replace
from typing import TYPE_CHECKING, Final, TypeVar

import numpy as np

from reliab.arrays import Array
from reliab.criterion.carrying import carry_to_length
from reliab.criterion.ellipse_table import DIMENSIONS, Ellipses, EllipseTable, names_along, tabled
from reliab.vocabulary import CurveName, Metric

if TYPE_CHECKING:
    import xarray as xr

PROTECTED_FROM: Final = 0.9
"""Share of the ground motions [-] from which on every length is protected."""

_LEAST_MOTIONS: Final = 30  # of a population, below which the dependence on their length is not learned
_LEAST_EARTHQUAKES: Final = 10
_MIDDLES_OF_THIRDS: Final = (1.0 / 6.0, 1.0 / 2.0, 5.0 / 6.0)
_UNFAVOURABLE: Final = 0.05  # quantile of a and b by which lengths are compared
_PROTECTED: Final = "each structure at the least favourable of"
_TOGETHER: Final = "all lengths together: short ones have less than the stated share, long ones more"
_Given = TypeVar("_Given", "xr.Dataset", EllipseTable)
_SAME: Final = 1.01  # ratio of lengths between which nothing is learned


def protect_over_lengths(
    ellipses: _Given,
    *,
    metric: str = Metric.RMS,
    curve: str = CurveName.INSCRIBED,
    confidence: float = PROTECTED_FROM,
) -> _Given:
    """Transfer the ellipses of a population to the least favourable of its lengths.

    Parameters
    ----------
    ellipses : xarray.Dataset or EllipseTable
        Ellipses of the population.
    metric : str, optional
        Error of the criterion; RMS^R alone depends on the length.
    curve : str, optional
        Ellipses on which the criterion will rest. Those that are fitted to boundaries are the paper's, whose
        criterion is one of motions as they were recorded.
    confidence : float, optional
        Share of the population's ground motions that the criterion will state [-]. Below 0.9 it is one of all
        lengths together.

    Returns
    -------
    xarray.Dataset or EllipseTable
        For each structure the inscribed ellipses of RMS^R at one of three lengths, the middles of the thirds
        of all; those of other errors and curves stay beside them. For shares below 0.9 the ellipses as they
        are, with a note that lengths stand together. The ellipses as they are where nothing can be learned of
        lengths: for a criterion of an error other than RMS^R, windows, a partly numerical structure, or fewer
        than thirty motions of ten earthquakes.

    Examples
    --------
    >>> from reliab.criterion import read_ellipses
    >>> protected = protect_over_lengths(read_ellipses("real_suite"))
    >>> protected.attrs["carried_to"]
    'each structure at the least favourable of 25, 39 and 56 s'
    """
    if metric != Metric.RMS or curve != CurveName.INSCRIBED or not _shows_lengths(ellipses):
        return ellipses
    if not protects(confidence):
        return _noted(ellipses, carried_to=_TOGETHER)
    protected = _protected(tabled(ellipses), metric, curve)
    if isinstance(ellipses, EllipseTable):
        return protected  # type: ignore[return-value]  # of the type that was given
    order = [DIMENSIONS.index(str(name)) for name in ellipses["a"].dims]
    arrays = {"a": protected.a.transpose(order), "b": protected.b.transpose(order)}
    filled = {
        name: ellipses[name].transpose(*ellipses["a"].dims).copy(data=values)
        for name, values in arrays.items()
    }
    return ellipses.assign(filled).assign_attrs(protected.attrs)


def protects(confidence: float) -> bool:
    """Whether a criterion that states this share [-] protects every length.

    >>> protects(0.8), protects(0.95)
    (False, True)
    """
    return confidence >= PROTECTED_FROM


def lengths_together(ellipses: Ellipses) -> bool:
    """Whether the limits depend on the length of a record although all lengths are pooled."""
    return str(ellipses.attrs.get("carried_to", "")).startswith(_TOGETHER)


def _noted(ellipses: _Given, **attrs: object) -> _Given:
    """Note attributes beside those that are there."""
    if isinstance(ellipses, EllipseTable):
        return ellipses.stating(**attrs)
    return ellipses.assign_attrs(attrs)


def _protected(table: EllipseTable, metric: str, curve: str) -> EllipseTable:
    places = (names_along(table, "metric").index(metric), names_along(table, "curve").index(curve))
    own = table.take(metric=places[:1], curve=places[1:])
    lengths = np.quantile(table.of_motions["duration"], _MIDDLES_OF_THIRDS)
    carried = [carry_to_length(own, float(length)) for length in lengths]
    a, b = table.a.astype(np.float64), table.b.astype(np.float64)
    for whole, parts in ((a, [part.a for part in carried]), (b, [part.b for part in carried])):
        whole[..., places[0], places[1], :] = _least_favourable(np.stack(parts))[..., 0, 0, :]
    first, second, third = (f"{length:.0f}" for length in lengths)
    words = f"{_PROTECTED} {first}, {second} and {third} s"
    return replace(table, a=a, b=b).stating(carried_to=words, position="inside", caution="")


def _least_favourable(values: Array) -> Array:
    """Values (lengths, motions, ...) at the length of the least quantile over motions; NaN is large."""
    large = np.where(np.isfinite(values), values, np.inf)
    low = np.quantile(large, _UNFAVOURABLE, axis=1, keepdims=True, method="lower")
    least = np.broadcast_to(low.argmin(axis=0)[None], (1, *values.shape[1:]))
    return np.asarray(np.take_along_axis(values, least, axis=0)[0])


def _shows_lengths(ellipses: Ellipses) -> bool:
    """Whether the population is large enough, and its errors such, that lengths tell something of limits."""
    if "carried_to" in ellipses.attrs or str(ellipses.attrs.get("window", "record")) != "record":
        return False
    if not isinstance(ellipses, EllipseTable) and set(ellipses["a"].dims) != set(DIMENSIONS):
        return False  # of several shares of the stiffness, or of an older version
    table = tabled(ellipses)
    lengths = table.of_motions.get("duration", np.empty(0))
    return (
        Metric.RMS in names_along(table, "metric")
        and CurveName.INSCRIBED in names_along(table, "curve")
        and table.share == 1.0
        and lengths.size >= _LEAST_MOTIONS
        and np.unique(table.events).size >= _LEAST_EARTHQUAKES
        and bool(lengths.max() > _SAME * lengths.min())
    )
