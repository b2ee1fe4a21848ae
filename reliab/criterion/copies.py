"""Copies of one record among ground motions: the same one twice, or scaled.

A linear structure has the same boundaries under both, so that they are recognised from any source.
"""

from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.ellipse_table import Ellipses, EllipseTable

if TYPE_CHECKING:
    import xarray as xr

_Given = TypeVar("_Given", "xr.Dataset", EllipseTable)

_ALIKE = 1e-5  # relative difference of boundaries from results in single precision; records differ by more
_WRITTEN_OUT = 2  # copies that a sentence names


def without_copies(ellipses: _Given) -> _Given:
    """Let each record count once, and note as `copies` which motions were left out."""
    first = _originals(ellipses)
    copied = np.flatnonzero(first != np.arange(first.size))
    if not copied.size:
        return ellipses
    names = _names(ellipses)
    pairs = [f"{names[place]} of {names[first[place]]}" for place in copied[:_WRITTEN_OUT]]
    more = ", …" if copied.size > _WRITTEN_OUT else ""
    sentence = (
        f"{copied.size} of {first.size} motions are the records of others, as they are or scaled "
        f"({', '.join(pairs)}{more}): each record counts once."
    )
    originals = np.unique(first)
    if isinstance(ellipses, EllipseTable):
        return ellipses.take(motion=originals).stating(copies=sentence)
    return ellipses.isel(motion=originals).assign_attrs(copies=sentence)


def events_of_originals(ellipses: Ellipses) -> NDArray[np.str_]:
    """Earthquake of each motion, copies having that of their record, shape (motions,)."""
    if isinstance(ellipses, EllipseTable):
        return ellipses.events[_originals(ellipses)]
    return np.asarray(ellipses["event"].values[_originals(ellipses)])


def _names(ellipses: Ellipses) -> list[str]:
    values = ellipses.at["motion"] if isinstance(ellipses, EllipseTable) else ellipses["motion"].values
    return [str(name) for name in values]


def _originals(ellipses: Ellipses) -> NDArray[np.intp]:
    """Find the first motion with the boundaries of each; motions without an ellipse have no copies.

    Returns places, shape (motions,).
    """
    rows = np.concatenate([_rows(ellipses, "a"), _rows(ellipses, "b")], axis=1)
    rows = np.where(rows > 0.0, rows, np.nan)
    first = np.arange(rows.shape[0])
    with_ellipse = np.flatnonzero(np.isfinite(rows).any(axis=1))
    order = with_ellipse[np.argsort(np.nansum(np.log(rows[with_ellipse]), axis=1), kind="stable")]
    alike = np.isclose(rows[order[1:]], rows[order[:-1]], rtol=_ALIKE, atol=0.0, equal_nan=True).all(axis=1)
    group = np.cumsum(np.append(0, ~alike))[: order.size]
    least = np.full(first.size, first.size)
    np.minimum.at(least, group, order)
    first[order] = least[group]
    return first


def _rows(ellipses: Ellipses, name: str) -> NDArray[np.float64]:
    """Parameters of each motion, shape (motions, others)."""
    if isinstance(ellipses, EllipseTable):
        values = ellipses.a if name == "a" else ellipses.b
    else:
        values = ellipses[name].transpose("motion", ...).values
    return values.reshape(values.shape[0], -1).astype(np.float64)
