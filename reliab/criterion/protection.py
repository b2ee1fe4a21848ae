"""A criterion that protects tests of every length of its population, where no length is stated.

RMS^R is a mean over the record. A criterion of motions as they were recorded promises too much for short
records: what they lack in quiet time is missing in the mean. The population is therefore carried to a short,
a middle and a long one of its lengths, and at each structure the least favourable of the three counts.
"""

from dataclasses import replace
from typing import TYPE_CHECKING, Final, TypeVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import CurveName, Metric
from reliab.criterion.carrying import carry_to_length
from reliab.criterion.ellipse_table import Ellipses, EllipseTable, names_along, tabled

if TYPE_CHECKING:
    import xarray as xr

_LEAST_MOTIONS: Final = 30  # of a population, below which its lengths are no sample of lengths
_LEAST_EARTHQUAKES: Final = 10
_PROTECTED: Final = (0.1, 0.5, 0.9)  # quantiles of the lengths that are protected
_UNFAVOURABLE: Final = 0.05  # quantile of a and b by which lengths are compared
_Given = TypeVar("_Given", "xr.Dataset", EllipseTable)


def protect_over_lengths(
    ellipses: _Given, *, metric: str = Metric.RMS, curve: str = CurveName.INSCRIBED
) -> _Given:
    """Transfer the ellipses of a population to the least favourable of its lengths.

    `metric`: error of the criterion; RMS^R alone depends on the length; `curve`: ellipses on which the
    criterion will rest. Those that are fitted to boundaries are the paper's, whose criterion is one of
    motions as they were recorded. Returns, for each structure, error, curve and side the ellipses at one of
    three lengths: those that a tenth, half and nine tenths of the records do not exceed. The ellipses as they
    are where nothing is known of cutting the records, for a criterion of an error other than RMS^R, and for
    fewer than thirty motions of ten earthquakes.

    >>> from reliab.criterion.ellipse_reading import read_ellipses
    >>> protected = protect_over_lengths(read_ellipses("real_suite"))
    >>> protected.attrs["carried_to"]
    'with the strictest limit of records of 21, 39 and 90 s'
    """
    if metric != Metric.RMS or curve != CurveName.INSCRIBED or not _shows_lengths(ellipses):
        return ellipses
    protected = _protected(tabled(ellipses))
    if isinstance(ellipses, EllipseTable):
        return protected  # type: ignore[return-value]  # of the type that was given
    return protected.to_dataset(ellipses)


def _protected(table: EllipseTable) -> EllipseTable:
    lengths = np.quantile(table.of_motions["duration"], _PROTECTED)
    carried = [carry_to_length(table, float(length)) for length in lengths]
    first, second, third = (f"{length:.0f}" for length in lengths)
    words = f"with the strictest limit of records of {first}, {second} and {third} s"
    return replace(
        table,
        a=_least_favourable(np.stack([table.a for table in carried])),
        b=_least_favourable(np.stack([table.b for table in carried])),
        cut_records=None,
    ).stating(carried_to=words)


def _least_favourable(values: Array) -> Array:
    """Values (lengths, motions, ...) at the length of the least quantile over motions; NaN is large."""
    large = np.where(np.isfinite(values), values, np.inf)
    low = np.quantile(large, _UNFAVOURABLE, axis=1, keepdims=True, method="lower")
    least = np.broadcast_to(low.argmin(axis=0)[None], (1, *values.shape[1:]))
    return np.asarray(np.take_along_axis(values, least, axis=0)[0])


def _shows_lengths(ellipses: Ellipses) -> bool:
    """Whether records can be cut, and are enough for their lengths to be those of others."""
    if isinstance(ellipses, EllipseTable):
        can_be_cut = ellipses.cut_records is not None and "duration" in ellipses.of_motions
    else:
        can_be_cut = {"a_cut", "duration"} <= set(ellipses.variables) and "alpha" not in ellipses.dims
    if not can_be_cut or Metric.RMS not in names_along(ellipses, "metric"):
        return False
    table = tabled(ellipses)
    return table.n_motions >= _LEAST_MOTIONS and np.unique(table.events).size >= _LEAST_EARTHQUAKES
