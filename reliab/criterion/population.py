"""The motions behind a criterion: their ellipses, and how probably a test stays below the threshold."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import LABELS, MILLI, CurveName, Dimension, Side
from reliab.criterion.ellipse_table import Ellipses, EllipseTable, as_table, names_along
from reliab.criterion.laws.law import LARGEST, Validity, scales, validate_grid
from reliab.criterion.laws.table import tents
from reliab.criterion.motion_predictive import MotionPredictive

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
    from reliab.sweep.labels import select_share

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


_DIGITS = 5
_LARGEST_LOGARITHM = 300.0  # whose exponential is still a number, as is its square


@dataclass(frozen=True, kw_only=True, eq=False)
class Population:
    """Dimensionless ellipses of motions over a grid of structures, for one threshold and metric."""

    frequencies: Array  # frequencies, damping_ratios: The grid [Hz, -], increasing
    damping_ratios: Array
    log_alpha: Array  # log_alpha, log_beta: ln(a/ξ²) and ln(bω₀²/ξ²); NaN where a motion has no ellipse
    log_beta: Array
    events: NDArray[np.str_]  # Earthquake of each motion

    def __post_init__(self) -> None:
        self._check_shapes()
        fewest = int(np.isfinite(self.log_alpha).sum(axis=0).min())
        if fewest < FEWEST_MOTIONS:
            raise InputError(
                f"Too few motions with an ellipse at every structure: a criterion needs {FEWEST_MOTIONS}",
                value=fewest,
                remedy="Give more motions, a smaller threshold or less damping",
            )

    def _check_shapes(self) -> None:
        """Refuse what a broken file may hold."""
        frequencies = validate_grid("natural frequencies", self.frequencies)
        damping_ratios = validate_grid("damping ratios", self.damping_ratios)
        shape = (self.events.size, frequencies.size, damping_ratios.size)
        has_equal_shapes = self.events.ndim == 1 and self.log_alpha.shape == self.log_beta.shape == shape
        if not has_equal_shapes or (np.isfinite(self.log_alpha) != np.isfinite(self.log_beta)).any():
            raise InputError(
                "The motions behind a criterion must have a pair of ellipse parameters for each structure",
                value=f"shapes {self.log_alpha.shape} and {self.log_beta.shape} for {shape}",
                remedy="Derive the criterion again",
            )
        sizes = np.abs([self.log_alpha, self.log_beta])
        if (sizes > _LARGEST_LOGARITHM).any():
            raise InputError(
                f"Logarithms of ellipse parameters must be between ±{_LARGEST_LOGARITHM:g}",
                value=f"{np.nanmax(sizes):g}",
                remedy="Derive the criterion again",
            )

    @classmethod
    def from_ellipses(
        cls,
        ellipses: Ellipses,
        *,
        threshold: float,
        metric: str,
        curve: str = CurveName.ELLIPSE,
        side: str = Side.LAG,
    ) -> Self:
        """Take the ellipses of one threshold and metric from a dataset.

        `ellipses`: `a` [-] and `b` [ms²] over (motion, f, xi, threshold, metric, curve, side).
        """
        table = as_table(ellipses).interpolate_threshold(threshold).sort("f", "xi")
        curve_places = places_of_curve(table, curve, side)
        metric_place = position_of_name(table, "metric", metric)
        place = (..., position(table, "threshold", threshold), metric_place, *curve_places)
        a, b = table.a[place], table.b[place]
        frequencies, damping_ratios = (table.coordinates[name].astype(np.float64) for name in ("f", "xi"))
        scale_a, scale_b = scales(frequencies[:, None], damping_ratios[None, :])
        sound = is_ellipse(a, b)
        return cls(
            frequencies=frequencies,
            damping_ratios=damping_ratios,
            log_alpha=np.log(np.where(sound, a / scale_a, np.nan)),
            log_beta=np.log(np.where(sound, b / scale_b, np.nan)),
            events=np.array(table.events.tolist(), dtype=np.str_),
        )

    @property
    def validity(self) -> Validity:
        """The hull of the grid."""
        return Validity(
            frequency=(float(self.frequencies[0]), float(self.frequencies[-1])),
            damping_ratio=(float(self.damping_ratios[0]), float(self.damping_ratios[-1])),
        )

    def probability(
        self, amplitude: ArrayLike, delay: ArrayLike, frequency: ArrayLike, damping_ratio: ArrayLike
    ) -> Array:
        """Predictive probability that a further motion's boundary holds a test.

        Along the ray from the perfect test through (A, d), each motion's boundary lies at a distance of
        its own; the distribution of that distance over motions of further earthquakes is learned as
        `MotionPredictive` describes. Between grid points, probabilities at the same dimensionless
        error are interpolated.

        `amplitude`: amplitude index A [-]; `delay`: equivalent delay d [s]; `frequency`, `damping_ratio`: the
        structure [Hz, -]; all four are broadcast against each other. Returns probability [-] in the broadcast
        shape.
        """
        self.validity.require(frequency, damping_ratio)
        arrays = np.broadcast_arrays(
            *(np.asarray(values, dtype=np.float64) for values in (amplitude, delay, frequency, damping_ratio))
        )
        capital_a, d, f, xi = (values.ravel() for values in arrays)
        scale_a, scale_b = scales(f, xi)
        u, v = (capital_a - 1.0) ** 2 / scale_a, (MILLI * d) ** 2 / scale_b
        f_weights, xi_weights = tents(self.frequencies, f), tents(self.damping_ratios, xi)
        perfect = (u == 0.0) & (v == 0.0)
        probability = perfect.astype(np.float64)
        for row, column in np.ndindex(self.frequencies.size, self.damping_ratios.size):
            weight = f_weights[:, row] * xi_weights[:, column]
            near = (weight > 0.0) & ~perfect
            if near.any():
                probability[near] += weight[near] * self._node_probability(u[near], v[near], row, column)
        return np.asarray(probability.reshape(arrays[0].shape))

    def _node_probability(self, u: Array, v: Array, row: int, column: int) -> Array:
        """Probability of dimensionless squared errors u and v, shape (points,), at one structure."""
        alpha, beta = np.exp(self.log_alpha[:, row, column]), np.exp(self.log_beta[:, row, column])
        is_known = np.isfinite(alpha)
        # The test lies on the ray at exp(room/2) times its own distance from the boundary.
        room = -np.log(u / alpha[is_known, None] + v / beta[is_known, None])
        predictive = MotionPredictive.fit(room, self.events[is_known])
        return np.asarray(1.0 - predictive.cumulative(np.zeros(u.size)))

    def to_dict(self) -> dict[str, Any]:
        """Plain lists for JSON; logarithms with five decimals, NaN as null."""
        # By hand, since the file of a criterion holds rounded numbers, which `from_dict` reads.
        return {
            "frequencies": self.frequencies.tolist(),
            "damping_ratios": self.damping_ratios.tolist(),
            "events": self.events.tolist(),
            "log_alpha": _plain(self.log_alpha),
            "log_beta": _plain(self.log_beta),
        }

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Make a population from what `to_dict` gave."""
        try:
            arrays = {
                name: np.asarray(values, dtype=np.float64)
                for name, values in content.items()
                if name != "events"
            }
        except ValueError as error:
            raise InputError(
                "The motions behind a criterion must be numbers in rows of one length",
                value=str(error),
                remedy="Derive the criterion again",
            ) from error
        return cls(events=np.asarray(content["events"], dtype=np.str_), **arrays)


def _plain(values: Array) -> list[Any]:
    rounded_values = values.round(_DIGITS).astype(object)
    rounded_values[np.isnan(values)] = None
    return list(rounded_values.tolist())


@dataclass(frozen=True, kw_only=True, eq=False)
class SampleGrid:
    """Ellipses at one error, of one curve, on one side of the boundaries."""

    # Motions of each structure, shape (frequencies, damping ratios)
    samples: tuple[tuple[EllipseSample, ...], ...]
    population: Population  # The same motions with gaps where they have no ellipse
    n_motions: int  # Number of motions that were offered
    threshold: float  # Error on the boundaries [-]
    metric: str  # metric, curve, side: Which error, which ellipses, and which side
    curve: str
    side: str

    @classmethod
    def from_ellipses(
        cls, ellipses: Ellipses, *, threshold: float, metric: str, curve: str, side: str
    ) -> Self:
        """Take the ellipses of one error, curve and side, in increasing order of f and ξ."""
        table = as_table(ellipses)
        selection = {"threshold": threshold, "metric": metric, "curve": curve, "side": side}
        population = Population.from_ellipses(table, **selection)  # type: ignore[arg-type]
        samples = tuple(
            tuple(sample_of(table, frequency=f, damping_ratio=xi, **selection) for xi in damping_ratios)  # type: ignore[arg-type]
            for damping_ratios in [population.damping_ratios.tolist()]
            for f in population.frequencies.tolist()
        )
        return cls(samples=samples, population=population, n_motions=table.n_motions, **selection)  # type: ignore[arg-type]

    @property
    def cells(self) -> list[EllipseSample]:
        """Motions of each structure, the damping ratio varying fastest."""
        return [sample for row in self.samples for sample in row]

    @property
    def frequencies(self) -> Array:
        """Natural frequencies [Hz], shape (F,), increasing."""
        return self.population.frequencies

    @property
    def damping_ratios(self) -> Array:
        """Damping ratios [-], shape (X,), increasing."""
        return self.population.damping_ratios

    @property
    def fewest_events(self) -> int:
        """Least number of earthquakes at a structure."""
        return min(sample.n_events for sample in self.cells)

    @property
    def fewest_motions(self) -> int:
        """Least number of motions with an ellipse at a structure."""
        return min(sample.n_motions for sample in self.cells)
