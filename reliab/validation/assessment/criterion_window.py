"""Ellipses for tests of a length: RMS^R falls with every quiet second, and limits grow with the window."""

import numpy as np
import xarray as xr

from reliab.vocabulary import Dimension

RECORD = "record"
"""Window of ellipses whose errors were computed over whole records."""

_SAME = 0.01  # share of a window's length by which a test may differ from it


def for_duration(ellipses: xr.Dataset, duration: float | None) -> xr.Dataset:
    """Take the ellipses of windows as long as a test.

    Parameters
    ----------
    ellipses : xarray.Dataset
        Ellipses with a dimension of windows, of which some are lengths in seconds.
    duration : float or None
        Length of the test [s]; whole records where None.

    Returns
    -------
    xarray.Dataset
        Without that dimension; ln a and ln b between two lengths are linear in that of the length. A test
        longer than the longest is judged by the longest, which is on the safe side; one shorter than the
        shortest by the shortest, which is not. The attribute `window` says which.
    """
    if Dimension.WINDOW not in ellipses.dims:
        return ellipses
    if duration is None:
        return _taken(ellipses, RECORD).assign_attrs(ellipses.attrs, window=RECORD)
    lengths = sorted(float(label) for label in ellipses[Dimension.WINDOW].values if _is_length(label))
    near = min(lengths, key=lambda length: abs(np.log(duration / length)))
    if abs(duration / near - 1.0) <= _SAME:
        chosen, label = _taken(ellipses, f"{near:g}"), f"{near:g}"
    elif duration > lengths[-1]:
        chosen, label = _taken(ellipses, f"{lengths[-1]:g}"), f"{lengths[-1]:g}, the longest that ships"
    elif duration < lengths[0]:
        chosen, label = _taken(ellipses, f"{lengths[0]:g}"), f"{lengths[0]:g}, the shortest that ships"
    else:
        above = next(length for length in lengths if length > duration)
        below = lengths[lengths.index(above) - 1]
        weight = np.log(duration / below) / np.log(above / below)
        chosen = _between(ellipses, f"{below:g}", f"{above:g}", weight)
        label = f"{duration:.3g}, interpolated between {below:g} and {above:g}"
    return chosen.assign_attrs(ellipses.attrs, window=label)


def _taken(ellipses: xr.Dataset, label: str) -> xr.Dataset:
    return ellipses.sel({Dimension.WINDOW: label}, drop=True)


def _between(ellipses: xr.Dataset, below: str, above: str, weight: float) -> xr.Dataset:
    names = ["a", "b"]
    sound = ellipses[names].where((ellipses["a"] > 0.0) & (ellipses["b"] > 0.0))
    low, high = (np.log(_taken(sound, label)) for label in (below, above))
    interpolated: xr.Dataset = np.exp((1.0 - weight) * low + weight * high)  # type: ignore[assignment]
    return _taken(ellipses, above).assign(interpolated)


def _is_length(label: str) -> bool:
    try:
        return float(label) > 0.0
    except ValueError:
        return False
