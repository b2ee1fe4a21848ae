"""Copies of one record among ground motions: the same record under several names.

A copy may be scaled, reversed or trimmed, and still tells nothing new of earthquakes. Records are known by
their checksums and outlines; where these are not stored, as in a table of ellipses, by their boundaries,
which are the same for a record that was scaled or reversed.
"""

from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.ellipse_table import Ellipses, EllipseTable
from reliab.motions.outline import are_copies

if TYPE_CHECKING:
    import xarray as xr

_Given = TypeVar("_Given", "xr.Dataset", EllipseTable)

_WRITTEN_OUT = 2  # copies that a sentence names
_SAME = 2e-4  # difference of ln a and ln b that rounding and tracing leave between a record and its copy


def without_copies(ellipses: _Given) -> _Given:
    """Let each record count once, and note as `copies` which motions were left out."""
    first = copied_from(ellipses)
    copied = np.flatnonzero(first != np.arange(first.size))
    if not copied.size:
        return ellipses
    names = _along_motions(ellipses, "motion")
    pairs = [f"{names[place]} of {names[first[place]]}" for place in copied[:_WRITTEN_OUT]]
    more = ", …" if copied.size > _WRITTEN_OUT else ""
    sentence = (
        f"{copied.size} of {first.size} motions are the records of others, as they are, scaled, reversed or "
        f"trimmed ({', '.join(pairs)}{more}): each record counts once."
    )
    originals = np.unique(first)
    if isinstance(ellipses, EllipseTable):
        return ellipses.take(motion=originals).stating(copies=sentence)
    return ellipses.isel(motion=originals).assign_attrs(copies=sentence)


def copied_from(ellipses: Ellipses) -> NDArray[np.intp]:
    """Find the first motion with the record of each, shape (motions,)."""
    alike = _have_same_boundary(ellipses)
    checksums, outlines = (_along_motions(ellipses, name) for name in ("checksum", "outline"))
    if checksums.size and all(checksums.tolist()):
        alike |= checksums[:, None] == checksums
    if outlines.size and all(outlines.tolist()):
        alike |= are_copies(outlines, outlines)
    return np.asarray(alike.argmax(axis=1))


def _along_motions(ellipses: Ellipses, name: str) -> NDArray[np.str_]:
    """Texts of the motions; empty where they are not known."""
    if isinstance(ellipses, EllipseTable):
        texts = ellipses.at["motion"] if name == "motion" else ellipses.of_motions.get(name, ())
    else:
        texts = ellipses[name].values if name in ellipses.coords else ()
    return np.array([str(text) for text in texts], dtype=np.str_)


def _have_same_boundary(ellipses: Ellipses) -> NDArray[np.bool_]:
    """Whether ellipses are the same wherever a motion has one, shape (motions, motions)."""
    rows = np.concatenate([_rows(ellipses, "a"), _rows(ellipses, "b")], axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        logarithms = np.log(np.where(rows > 0.0, rows, np.nan))
    alike = np.eye(len(rows), dtype=bool)
    finite = np.isfinite(logarithms)
    for place, row in enumerate(logarithms):
        cells = finite[place]
        if cells.any():  # motions without an ellipse have nothing in common
            near = np.abs(logarithms[:, cells] - row[cells]) <= _SAME
            alike[place] |= near.all(axis=1) & (finite == cells).all(axis=1)
    return alike


def _rows(ellipses: Ellipses, name: str) -> NDArray[np.float64]:
    """Parameters of each motion, shape (motions, others)."""
    if isinstance(ellipses, EllipseTable):
        values = ellipses.a if name == "a" else ellipses.b
    else:
        values = ellipses[name].transpose("motion", ...).values
    return values.reshape(values.shape[0], -1).astype(np.float64)
