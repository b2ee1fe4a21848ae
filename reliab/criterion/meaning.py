"""Thresholds so large that even an actuator that does not move would keep them."""

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.ellipse_sample import position, position_of_name
from reliab.criterion.ellipse_table import Ellipses, tabled
from reliab.errors import InputError
from reliab.significant import percent

MOST_AT_REST = 0.05
"""Largest share of motions under which an actuator at rest may keep the threshold."""


def share_at_rest(errors: NDArray[np.float64], threshold: float) -> NDArray[np.float64]:
    """Share of motions under which an actuator at rest keeps a threshold.

    `errors` (motions, ...) [-]; `threshold` [-].
    Returns shares of the motions with a known error, in the trailing shape; 0 where none is known.

    >>> share_at_rest(np.array([[0.15, 0.3], [0.25, np.nan], [0.4, 0.2]]), 0.2).round(2).tolist()
    [0.33, 0.5]
    """
    known = np.isfinite(errors)
    kept = (known & (errors <= threshold)).sum(axis=0)
    return np.asarray(kept / np.maximum(known.sum(axis=0), 1))


def require_meaning(ellipses: Ellipses, *, threshold: float, metric: str) -> None:
    """Refuse a threshold that an actuator at rest keeps under more than one motion in twenty.

    The amplitude and the delay of a test that hardly moves do not show its error. Ellipses without
    `error_at_rest` (older files, tables in CSV) cannot be checked.

    Parameters
    ----------
    ellipses : xarray.Dataset or EllipseTable
        Ellipses of the structures that are asked for.
    threshold : float
        Error [-].
    metric : str
        Which error.

    Raises
    ------
    InputError
        If an actuator at rest would pass; the message names the structure where it does most often.
    """
    table = tabled(ellipses)
    if table.error_at_rest is None:
        return
    errors = table.error_at_rest[..., position_of_name(table, "metric", metric)]
    position(table, "threshold", threshold)
    shares = share_at_rest(errors.astype(np.float64), threshold)
    if shares.max() <= MOST_AT_REST:
        return
    row, column = np.unravel_index(int(shares.argmax()), shares.shape)
    f, xi = float(table.at["f"][row]), float(table.at["xi"][column])
    raise InputError(
        "An actuator that does not move must exceed the error threshold under at least 95 % of the motions",
        value=(
            f"{percent(shares.max(), decimals=0)} of the motions under which it stays below "
            f"{threshold:g} at f = {f:g} Hz and "
            f"ξ = {xi:g}"
        ),
        remedy="Give a smaller threshold, at which amplitude and delay still separate good tests from "
        "bad ones",
    )
