"""Divisions of the motions by the names that they have in studies and on the command line."""

from collections.abc import Callable, Iterator, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.errors import InputError
from reliab.validation.cross_validation.folds import Fold, k_fold, leave_one_event_out, random_halves

GROUPS: Final = 5
"""Groups of earthquakes of the scheme k_fold."""

SPLITS: Final = 20
"""Divisions of the scheme random_halves."""

SCHEMES: Final[Mapping[str, Callable[[NDArray[np.str_]], Iterator[Fold]]]] = {
    "leave_one_event_out": leave_one_event_out,
    "k_fold": lambda events: k_fold(events, GROUPS),
    "random_halves": lambda events: random_halves(events, SPLITS),
}
"""Every scheme by its name; each takes the earthquakes of the motions."""


def folds_of(scheme: str, events: NDArray[np.str_]) -> list[Fold]:
    """Divide motions.

    `events` (motions,).

    >>> len(folds_of("leave_one_event_out", np.array(["K", "K", "L", "M"])))
    3
    """
    if scheme not in SCHEMES:
        raise InputError(
            "The scheme must be known", value=scheme, remedy=f"Choose among {', '.join(SCHEMES)}"
        )
    return list(SCHEMES[scheme](events))
