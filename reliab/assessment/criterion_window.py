"""Choice of the window of the shipped ellipses for a test of a given length.

RMS^R falls with every quiet second, so that limits grow with the window.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from reliab.significant import significant

RECORD = "record"
"""Window of ellipses whose errors were computed over whole records."""

_SAME = 0.01  # share of a window's length by which a test may differ from it


@dataclass(frozen=True, kw_only=True)
class CriterionWindow:
    """Two windows between which ellipses are interpolated, ln a and ln b over the logarithm of the length."""

    below: str  # below, above: The windows; the same where one suits
    above: str
    weight: float  # Weight of the second
    label: str  # The choice in words


def window_for(duration: float | None, stored: Iterable[str]) -> CriterionWindow:
    """Choose windows for tests of a length.

    `duration` [s].
    Returns one window, or two between which the length lies. A test longer than the longest is judged by the
    longest, which is on the safe side; one shorter than the shortest by the shortest, which is not.

    >>> window_for(25.0, ["record", "20", "30"]).label
    '25 s, between those of 20 s and 30 s'
    >>> window_for(90.0, ["record", "20", "30"]).label
    '30 s, the longest that ships'
    """
    lengths = sorted(float(label) for label in stored if _is_length(label))
    if duration is None or not lengths:
        return CriterionWindow(below=RECORD, above=RECORD, weight=0.0, label=RECORD)
    above = min((length for length in lengths if length >= duration), default=lengths[-1])
    below = max((length for length in lengths if length <= duration), default=lengths[0])
    near = min((below, above), key=lambda length: abs(np.log(duration / length)))
    if below != above and abs(duration / near - 1.0) > _SAME:
        return CriterionWindow(
            below=f"{below:g}",
            above=f"{above:g}",
            weight=float(np.log(duration / below) / np.log(above / below)),
            label=f"{significant(duration)} s, between those of {below:g} s and {above:g} s",
        )
    note = ""
    if abs(duration / near - 1.0) > _SAME:
        note = ", the longest that ships" if duration > near else ", the shortest that ships"
    return CriterionWindow(below=f"{near:g}", above=f"{near:g}", weight=0.0, label=f"{near:g} s{note}")


def _is_length(label: str) -> bool:
    try:
        return float(label) > 0.0
    except ValueError:
        return False
