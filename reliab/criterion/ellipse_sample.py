"""Ellipses of many ground motions at one structure and one error: what a criterion is derived from."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import LABELS, CurveName, Dimension, Side
from reliab.criterion.ellipse_table import Ellipses, EllipseTable, as_table, names_along
from reliab.criterion.laws.law import LARGEST

if TYPE_CHECKING:
    import xarray as xr

FEWEST_MOTIONS = 3
"""A spread cannot be learned from fewer."""

_ROUNDING = 1e-6  # relative differences below that are rounding, not ground motions


@dataclass(frozen=True, kw_only=True, eq=False)
class EllipseSample:
    """Ellipse parameters over ground motions, for one structure, threshold and metric.

    >>> sample = EllipseSample(
    ...     a=np.array([1e-4, 2e-4, 4e-4]), b=np.array([2.0, 4.0, 8.0]),
    ...     motions=np.array(["K/1", "K/2", "L/1"]), events=np.array(["K", "K", "L"]),
    ...     frequency=1.0, damping_ratio=0.02, threshold=0.05, metric="rms",
    ... )
    >>> sample.n_motions, sample.n_events, round(sample.correlation, 3)
    (3, 2, 1.0)
    """

    a: Array  # Amplitude parameters [-], positive
    b: Array  # Delay parameters [ms²], positive
    motions: NDArray[np.str_]  # motions, events: Names of the motions and of their earthquakes
    events: NDArray[np.str_]
    frequency: float  # Natural frequency of the structure [Hz]
    damping_ratio: float  # Its damping ratio [-]
    threshold: float  # Error on the boundaries [-]
    metric: str  # Which error, "rms" or "mte"

    def __post_init__(self) -> None:
        if self.a.size < FEWEST_MOTIONS:
            raise InputError(
                f"Too few ground motions: a criterion needs {FEWEST_MOTIONS}",
                value=self.a.size,
                remedy="Give more motions",
            )
        for name, values in (("a", self.a), ("b", self.b)):
            wrong = ~((values > 1.0 / LARGEST) & (values < LARGEST))
            if wrong.any():
                raise InputError(
                    f"The ellipse parameter {name} must be between {1.0 / LARGEST:g} and {LARGEST:g}",
                    value=values[wrong][0],
                    remedy="Leave the motion out, or trace its boundary again",
                    where=str(self.motions[wrong][0]),
                )
            if np.ptp(np.log(values)) < _ROUNDING:
                raise InputError(
                    f"The ellipse parameter {name} is the same for all ground motions",
                    value=f"{values.size} times {values[0]:g}",
                    remedy="Give different ground motions, each one once",
                )

    @property
    def log_a(self) -> Array:
        """Logarithms of a, shape (motions,)."""
        return np.log(self.a)

    @property
    def log_b(self) -> Array:
        """Logarithms of b [ms²], shape (motions,)."""
        return np.log(self.b)

    @property
    def n_motions(self) -> int:
        """Number of motions."""
        return int(self.a.size)

    @property
    def n_events(self) -> int:
        """Number of earthquakes."""
        return int(np.unique(self.events).size)

    @property
    def correlation(self) -> float:
        """Correlation coefficient of a and b, the paper's 0.9774."""
        return float(np.corrcoef(self.a, self.b)[0, 1])


def sample_of(
    ellipses: Ellipses,
    *,
    frequency: float,
    damping_ratio: float,
    threshold: float,
    metric: str,
    curve: str = CurveName.ELLIPSE,
    side: str = Side.LAG,
) -> EllipseSample:
    """Take the ellipses of one structure at one error from a dataset.

    `ellipses`: `a` [-] and `b` [ms²] over (motion, f, xi, threshold, metric, curve, side), with the
    coordinate `event`; `frequency`: natural frequency of the structure [Hz]; `damping_ratio`: its damping
    ratio [-]; `threshold`: error on the boundaries [-]; `curve`: which ellipses: fitted to the boundaries by
    least squares, or inscribed. Returns every motion for which both parameters are positive and finite.
    """
    table = as_table(ellipses).interpolate_threshold(threshold)
    curve_places = places_of_curve(table, curve, side)
    numbers = (("f", frequency), ("xi", damping_ratio), ("threshold", threshold))
    places: Any = tuple(position(table, name, value) for name, value in numbers)
    places = (..., *places, position_of_name(table, "metric", metric), *curve_places)
    a, b = table.a[places], table.b[places]
    has_ellipse = is_ellipse(a, b)
    return EllipseSample(
        a=a[has_ellipse].astype(np.float64),
        b=b[has_ellipse].astype(np.float64),
        motions=np.array(table.coordinates["motion"][has_ellipse].tolist(), dtype=np.str_),
        events=np.array(table.events[has_ellipse].tolist(), dtype=np.str_),
        frequency=frequency,
        damping_ratio=damping_ratio,
        threshold=threshold,
        metric=metric,
    )


def places_of_curve(table: EllipseTable, curve: str, side: str) -> tuple[int, int]:
    """Find one kind of ellipse and one side of the boundaries, or say which there are."""
    return position_of_name(table, "curve", curve), position_of_name(table, "side", side)


def select_curve(ellipses: "xr.Dataset", curve: str, side: str) -> "xr.Dataset":
    """Take one kind of ellipse and one side of the boundaries from a dataset.

    `ellipses`: over motions, structures and errors. Without the dimension `curve` its ellipses are those
    fitted by least squares; without the dimension `side` they are of lags.
    """
    from reliab.sweep.shares import select_share

    ellipses = select_share(ellipses)
    for name, value in ((Dimension.CURVE, curve), (Dimension.SIDE, side)):
        if name in ellipses.dims:
            ellipses = ellipses.isel({name: position_of_name(ellipses, name, value)})
        elif value not in names_along(ellipses, name):
            raise _absent(name, value, names_along(ellipses, name))
    return ellipses


def position_of_name(ellipses: Ellipses, name: str, value: str) -> int:
    """Find a name along the dimension `curve`, `side` or `metric`, or say which there are."""
    names = names_along(ellipses, name)
    if value not in names:
        raise _absent(name, value, names)
    return names.index(value)


def _absent(name: str, value: str, names: list[str]) -> InputError:
    return InputError(
        f"The ellipses were not traced for this {LABELS[str(name)].long_name}",
        value=value,
        remedy=f"Choose among {', '.join(names)}, or trace the boundaries again",
    )


def is_ellipse(a: Array, b: Array) -> NDArray[np.bool_]:
    """Tell where both parameters describe an ellipse.

    A boundary that reaches beyond five damping ratios of amplitude error is cut there, and the straight line
    of equation (9) may then have no ellipse. Such a motion tolerates more than any criterion would allow.
    Leaving it out is on the safe side for methods that count motions; a fitted distribution is narrowed by
    it, and its lower quantile may lie a little too high: with the upper 8 % of lognormal motions gone, by
    0.06 standard deviations, so that a bound at 95 % contains 94.3 %.

    `a`, `b`: ellipse parameters, any shape. Returns True where a and b are positive and finite.
    """
    return np.asarray(np.isfinite(a) & np.isfinite(b) & (a > 0.0) & (b > 0.0))


def position(table: EllipseTable, name: str, value: float) -> int:
    """Find a value along a dimension."""
    values = table.coordinates[name].astype(np.float64)
    close = np.flatnonzero(np.isclose(values, value, rtol=1e-9, atol=0.0))
    if close.size == 0:
        raise InputError(
            f"The ellipses were not traced for this {table.words.get(name, name)}",
            value=f"{value:g}",
            remedy=f"Choose among {', '.join(f'{value:g}' for value in values)}",
        )
    return int(close[0])
