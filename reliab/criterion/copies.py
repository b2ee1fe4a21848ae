"""Copies of one record among ground motions: the same record under several names.

They are recognised by their checksums; where these are not known, as in a table of ellipses, by their
boundaries.
"""

from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.ellipse_table import Ellipses, EllipseTable

if TYPE_CHECKING:
    import xarray as xr

_Given = TypeVar("_Given", "xr.Dataset", EllipseTable)

_WRITTEN_OUT = 2  # copies that a sentence names


def without_copies(ellipses: _Given) -> _Given:
    """Let each record count once, and note as `copies` which motions were left out."""
    first = _originals(ellipses)
    copied = np.flatnonzero(first != np.arange(first.size))
    if not copied.size:
        return ellipses
    names = _along_motions(ellipses, "motion")
    pairs = [f"{names[place]} of {names[first[place]]}" for place in copied[:_WRITTEN_OUT]]
    more = ", …" if copied.size > _WRITTEN_OUT else ""
    sentence = (
        f"{copied.size} of {first.size} motions are the records of others ({', '.join(pairs)}{more}): "
        "each record counts once."
    )
    originals = np.unique(first)
    if isinstance(ellipses, EllipseTable):
        return ellipses.take(motion=originals).stating(copies=sentence)
    return ellipses.isel(motion=originals).assign_attrs(copies=sentence)


def events_of_originals(ellipses: Ellipses) -> NDArray[np.str_]:
    """Earthquake of each motion, copies having that of their record, shape (motions,)."""
    return _along_motions(ellipses, "event")[_originals(ellipses)]


def _along_motions(ellipses: Ellipses, name: str) -> NDArray[np.str_]:
    """Texts of the motions; empty where they are not known."""
    if isinstance(ellipses, EllipseTable):
        texts = ellipses.at["motion"] if name == "motion" else ellipses.of_motions.get(name, ())
    else:
        texts = ellipses[name].values if name in ellipses.coords else ()
    return np.array([str(text) for text in texts], dtype=np.str_)


def _originals(ellipses: Ellipses) -> NDArray[np.intp]:
    """Find the first motion with the record of each, shape (motions,)."""
    checksums = _along_motions(ellipses, "checksum")
    if checksums.size and all(checksums.tolist()):
        identities = checksums.tolist()
    else:
        rows = np.concatenate([_rows(ellipses, "a"), _rows(ellipses, "b")], axis=1)
        known = np.isfinite(rows).any(axis=1).tolist()  # motions without an ellipse have nothing in common
        identities = [row.tobytes() if known[place] else place for place, row in enumerate(rows)]
    first: dict[object, int] = {}
    return np.array([first.setdefault(identity, place) for place, identity in enumerate(identities)])


def _rows(ellipses: Ellipses, name: str) -> NDArray[np.float64]:
    """Parameters of each motion, shape (motions, others)."""
    if isinstance(ellipses, EllipseTable):
        values = ellipses.a if name == "a" else ellipses.b
    else:
        values = ellipses[name].transpose("motion", ...).values
    return values.reshape(values.shape[0], -1).astype(np.float64)
