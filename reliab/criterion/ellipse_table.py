"""Ellipses of ground motions in plain arrays, with which criteria are computed; users have xarray."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Self, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import ELLIPSE_DIMENSIONS, LABELS, SHARE_ATTRIBUTE, CurveName, Dimension, Side
from reliab.motions.motion import are_copies

if TYPE_CHECKING:
    import xarray as xr


Ellipses: TypeAlias = "xr.Dataset | EllipseTable"
"""Ellipses with labels, as users have them, or in plain arrays."""

REST = "error_at_rest"
"""Variable of the ellipses: error of the whole test with an actuator at rest, over (motion, f, xi,
metric)."""

CUT = ("a_cut", "b_cut")
"""Variables of the ellipses: ratios of a and b of a record cut to a `length` to those of the whole record."""

_FIRST_ORDER_THRESHOLD = 0.01
"""Error below which a and b of the ellipses that ship are proportional to its square, within 3 % (median)."""

_Table = TypeVar("_Table", bound="EllipseTable")
DIMENSIONS = tuple(str(name) for name in ELLIPSE_DIMENSIONS)
_REST_DIMENSIONS = ("motion", "f", "xi", "metric")
_CUT_DIMENSIONS = ("motion", "f", "xi", "length")
_DEFAULTS_OF_OLDER_FILES = {"curve": str(CurveName.ELLIPSE), "side": str(Side.LAG)}


@dataclass(frozen=True, kw_only=True, eq=False)
class CutRecords:
    """How a and b of RMS^R of whole records change when the records are cut."""

    lengths: Array  # [s], shape (lengths,), increasing
    ratios: Array  # a and b over those of the whole records [-], shape (motions, f, ξ, lengths, 2)

    def interpolate(self, length: float) -> Array:
        """Ratios at a length [s], shape (motions, f, ξ, 2).

        Between lengths their logarithms are linear in that of the length; beyond the ends they stay.
        """
        length = float(np.clip(length, self.lengths[0], self.lengths[-1]))
        upper_index = int(np.clip(np.searchsorted(self.lengths, length), 1, self.lengths.size - 1))
        low, high = np.log(self.lengths[upper_index - 1 : upper_index + 1])
        weight = (np.log(length) - low) / (high - low)
        lower_logarithms, upper_logarithms = (
            np.log(self.ratios[..., place, :]) for place in (upper_index - 1, upper_index)
        )
        return np.asarray(np.exp((1.0 - weight) * lower_logarithms + weight * upper_logarithms))


@dataclass(frozen=True, kw_only=True, eq=False)
class EllipseTable:
    """Ellipses of ground motions over structures and errors, of one share of the stiffness."""

    # a, b: Parameters [-] and [ms²], shape (motion, f, xi, threshold, metric, curve, side)
    a: Array
    b: Array
    coordinates: Mapping[str, NDArray[Any]]  # Values along each dimension, by its name
    # `event` of each motion, and where they are known `duration` [s] and `checksum`
    motion_values: Mapping[str, NDArray[Any]]
    error_at_rest: Array | None = None  # [-], shape (motion, f, xi, metric)
    cut_records: CutRecords | None = None  # Of whole records, where these were at hand
    attrs: Mapping[str, Any] = field(default_factory=dict)  # Window, share of the stiffness, and the like
    words: Mapping[str, str] = field(default_factory=dict)  # What dimensions are called in sentences

    @classmethod
    def from_dataset(cls, ellipses: "xr.Dataset") -> Self:
        """Take the arrays of a dataset; one without curves or sides is of fitted ellipses and of lags.

        Raises InputError if it is of several shares of the stiffness.
        """
        from reliab.sweep.labels import select_share

        ellipses = select_share(ellipses)
        lacking = [name for name in _DEFAULTS_OF_OLDER_FILES if name not in ellipses.dims]
        present_dimensions = [name for name in DIMENSIONS if name not in lacking]
        axes = tuple(DIMENSIONS.index(name) for name in lacking)
        a, b = (
            np.expand_dims(ellipses[name].transpose(*present_dimensions).values, axes).view()
            for name in ("a", "b")
        )
        return cls(
            a=a,
            b=b,
            coordinates={
                **{name: ellipses[name].values for name in present_dimensions},
                **{name: np.array(names_along(ellipses, name)) for name in lacking},
            },
            motion_values={
                str(name): part.values
                for name, part in ellipses.coords.items()
                if part.dims == ("motion",) and name != "motion"
            },
            error_at_rest=ellipses[REST].transpose(*_REST_DIMENSIONS).values if REST in ellipses else None,
            cut_records=_cut_records(ellipses),
            attrs={str(name): value for name, value in ellipses.attrs.items()},
            words={
                name: str(ellipses[name].attrs.get("long_name", name))
                for name in present_dimensions
                if name in ellipses.coords
            },
        )

    def to_dataset(self, like: "xr.Dataset | None" = None) -> "xr.Dataset":
        """Put the arrays into a dataset whose variables are described as those of another one."""
        import xarray as xr

        variables: dict[str, Any] = {"a": (DIMENSIONS, self.a), "b": (DIMENSIONS, self.b)}
        coordinates: dict[str, Any] = {
            name: ("motion", values) for name, values in self.motion_values.items()
        }
        if self.cut_records is not None:
            coordinates["length"] = self.cut_records.lengths
            ratios = np.moveaxis(self.cut_records.ratios, -1, 0)
            variables |= {name: (_CUT_DIMENSIONS, ratio) for name, ratio in zip(CUT, ratios, strict=True)}
        if self.error_at_rest is not None:
            variables[REST] = (_REST_DIMENSIONS, self.error_at_rest)
        dataset = xr.Dataset(variables, coords={**self.coordinates, **coordinates}, attrs=dict(self.attrs))
        for name in dataset.variables if like is not None else ():
            if like is not None and name in like.variables:
                dataset[name].attrs.update(like[name].attrs)
        return dataset

    @property
    def share(self) -> float:
        """Share of the stiffness in the laboratory [-]."""
        return float(self.attrs.get(SHARE_ATTRIBUTE, 1.0))

    @property
    def events(self) -> NDArray[Any]:
        """Earthquake of each motion, shape (motions,)."""
        return self.motion_values["event"]

    @property
    def n_motions(self) -> int:
        """Number of motions."""
        return int(self.a.shape[0])

    def take(self, **places: ArrayLike) -> Self:
        """Take places along dimensions, which all stay."""
        a, b, rest_errors, cut = self.a, self.b, self.error_at_rest, self.cut_records
        coordinates, motion_values = dict(self.coordinates), dict(self.motion_values)
        for name, selection in places.items():
            indices = np.asarray(selection)
            indices = np.flatnonzero(indices) if indices.dtype == np.bool_ else indices
            axis = DIMENSIONS.index(name)
            a, b = np.take(a, indices, axis), np.take(b, indices, axis)
            coordinates[name] = coordinates[name][indices]
            if rest_errors is not None and name in _REST_DIMENSIONS:
                rest_errors = np.take(rest_errors, indices, _REST_DIMENSIONS.index(name))
            if cut is not None and name in _CUT_DIMENSIONS:
                cut = replace(cut, ratios=np.take(cut.ratios, indices, _CUT_DIMENSIONS.index(name)))
            if name == Dimension.MOTION:
                motion_values = {label: values[indices] for label, values in motion_values.items()}
        return replace(
            self,
            a=a,
            b=b,
            coordinates=coordinates,
            motion_values=motion_values,
            error_at_rest=rest_errors,
            cut_records=cut,
        )

    def sort(self, *names: str) -> Self:
        """Put the values of dimensions into increasing order."""
        return self.take(**{name: np.argsort(self.coordinates[name], kind="stable") for name in names})

    def interpolate_threshold(self, threshold: float) -> Self:
        """Ellipses of one error [-].

        Between two errors of this table ln a and ln b are linear in the logarithm of the error. Below its
        smallest one, if that is 1 % or less, a and b are proportional to the square of the error.
        """
        thresholds = self.coordinates["threshold"].astype(np.float64)
        low, high = float(thresholds.min()), float(thresholds.max())
        if np.isclose(thresholds, threshold, rtol=1e-9, atol=0.0).any():
            return self.take(threshold=neighbours(thresholds, threshold))
        if not 0.0 < threshold <= high or (threshold < low and low > _FIRST_ORDER_THRESHOLD * (1.0 + 1e-9)):
            raise InputError(
                f"The ellipses were not traced for this {self.words.get('threshold', 'threshold')}",
                value=f"{threshold:g}",
                remedy=f"Choose among {', '.join(f'{value:g}' for value in thresholds)} or between them, or "
                "trace boundaries of this error with `reliab ellipses --motions`",
            )
        near = self.take(threshold=neighbours(thresholds, threshold))
        if threshold < low:
            smaller = (threshold / low) ** 2
            near = replace(near, a=near.a * smaller, b=near.b * smaller)
        else:
            lower_table, upper_table = (near.take(threshold=[place]) for place in (0, 1))
            places = np.log(near.coordinates["threshold"].astype(np.float64))
            near = interpolate_tables(
                lower_table, upper_table, float((np.log(threshold) - places[0]) / np.ptp(places))
            )
        return replace(near, coordinates={**near.coordinates, "threshold": np.array([threshold])})

    def stating(self, **attrs: object) -> Self:
        """Note attributes beside those that are there."""
        return replace(self, attrs={**self.attrs, **attrs})


def _cut_records(ellipses: "xr.Dataset") -> CutRecords | None:
    if any(name not in ellipses for name in CUT):
        return None
    ratios = [ellipses[name].transpose(*_CUT_DIMENSIONS).values.astype(np.float64) for name in CUT]
    return CutRecords(lengths=ellipses["length"].values.astype(np.float64), ratios=np.stack(ratios, axis=-1))


def neighbours(values: NDArray[Any], value: float) -> NDArray[np.int64]:
    """Places of one stored value, or of the two on either side in increasing order.

    >>> neighbours(np.array([0.2, 0.1, 0.05]), 0.12), neighbours(np.array([0.2, 0.1]), 0.3)
    (array([1, 0]), array([0]))
    """
    order = np.argsort(values)
    sorted_values = values[order].astype(np.float64)
    place = int(np.clip(np.searchsorted(sorted_values, value * (1.0 - 1e-9)), 0, sorted_values.size - 1))
    if (
        np.isclose(sorted_values[place], value, rtol=1e-9)
        or value < sorted_values[0]
        or value > sorted_values[-1]
    ):
        return order[place : place + 1]
    return order[place - 1 : place + 1]


def interpolate_tables(lower_table: _Table, upper_table: _Table, weight: float) -> _Table:
    """Ellipses between two tables, ln a and ln b being linear in the weight of the second."""
    (a_low, b_low), (a_high, b_high) = _logarithms(lower_table), _logarithms(upper_table)
    share = 1.0 - weight
    return replace(
        upper_table,
        a=np.exp(share * a_low + weight * a_high),
        b=np.exp(share * b_low + weight * b_high),
    )


def _logarithms(table: EllipseTable) -> tuple[Array, Array]:
    """Logarithms of a and b; NaN where a motion has no ellipse."""
    sound = (table.a > 0.0) & (table.b > 0.0)
    return np.log(np.where(sound, table.a, np.nan)), np.log(np.where(sound, table.b, np.nan))


def as_table(ellipses: Ellipses) -> EllipseTable:
    """Take the arrays of ellipses with labels."""
    return ellipses if isinstance(ellipses, EllipseTable) else EllipseTable.from_dataset(ellipses)


def interpolate_threshold(ellipses: "xr.Dataset", threshold: float) -> "xr.Dataset":
    """Ellipses that hold an error [-], stored or as :meth:`EllipseTable.interpolate_threshold` finds it."""
    if np.isclose(ellipses["threshold"].values, threshold, rtol=1e-9, atol=0.0).any():
        return ellipses
    dataset = EllipseTable.from_dataset(ellipses).interpolate_threshold(threshold).to_dataset(like=ellipses)
    return dataset.assign({name: ellipses[name] for name in (REST,) if name in ellipses})


def names_along(ellipses: Ellipses, name: str) -> list[str]:
    """List the names along `curve`, `side` or `metric`; older files hold fitted ellipses of lags."""
    if isinstance(ellipses, EllipseTable):
        return [str(value) for value in ellipses.coordinates[name]]
    if name in ellipses.coords:
        return [str(value) for value in np.atleast_1d(ellipses[name].values)]
    return [_DEFAULTS_OF_OLDER_FILES[name]]


def words_of(names: Sequence[str] = DIMENSIONS) -> dict[str, str]:
    """Say what dimensions are called in sentences."""
    return {name: LABELS[name].long_name for name in names}


_Ellipses = TypeVar("_Ellipses", "xr.Dataset", EllipseTable)

_WRITTEN_OUT = 2  # copies that a sentence names
_COPY_TOLERANCE = (
    2e-4  # difference of ln a and ln b that rounding and tracing leave between a record and its copy
)


def drop_copies(ellipses: _Ellipses) -> _Ellipses:
    """Let each record count once, and note as `copies` which motions were left out."""
    first = first_copies(ellipses)
    copies = np.flatnonzero(first != np.arange(first.size))
    if not copies.size:
        return ellipses
    names = _motion_texts(ellipses, "motion")
    pairs = [f"{names[place]} of {names[first[place]]}" for place in copies[:_WRITTEN_OUT]]
    ellipsis = ", …" if copies.size > _WRITTEN_OUT else ""
    sentence = (
        f"{copies.size} of {first.size} motions are the records of others, as they are, scaled, reversed or "
        f"trimmed ({', '.join(pairs)}{ellipsis}): each record counts once."
    )
    originals = np.unique(first)
    if isinstance(ellipses, EllipseTable):
        return ellipses.take(motion=originals).stating(copies=sentence)
    return ellipses.isel(motion=originals).assign_attrs(copies=sentence)


def first_copies(ellipses: Ellipses) -> NDArray[np.intp]:
    """Find the first motion with the record of each, shape (motions,)."""
    is_copy = _have_same_boundary(ellipses)
    checksums, outlines = (_motion_texts(ellipses, name) for name in ("checksum", "outline"))
    if checksums.size and all(checksums.tolist()):
        is_copy |= checksums[:, None] == checksums
    if outlines.size and all(outlines.tolist()):
        is_copy |= are_copies(outlines, outlines)
    return np.asarray(is_copy.argmax(axis=1))


def _motion_texts(ellipses: Ellipses, name: str) -> NDArray[np.str_]:
    """Texts of the motions; empty where they are not known."""
    if isinstance(ellipses, EllipseTable):
        texts = ellipses.coordinates["motion"] if name == "motion" else ellipses.motion_values.get(name, ())
    else:
        texts = ellipses[name].values if name in ellipses.coords else ()
    return np.array([str(text) for text in texts], dtype=np.str_)


def _have_same_boundary(ellipses: Ellipses) -> NDArray[np.bool_]:
    """Whether ellipses are the same wherever a motion has one, shape (motions, motions)."""
    rows = np.concatenate([_rows(ellipses, "a"), _rows(ellipses, "b")], axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        logarithms = np.log(np.where(rows > 0.0, rows, np.nan))
    is_copy = np.eye(len(rows), dtype=bool)
    finite = np.isfinite(logarithms)
    for place, row in enumerate(logarithms):
        cells = finite[place]
        if cells.any():  # motions without an ellipse have nothing in common
            near = np.abs(logarithms[:, cells] - row[cells]) <= _COPY_TOLERANCE
            is_copy[place] |= near.all(axis=1) & (finite == cells).all(axis=1)
    return is_copy


def _rows(ellipses: Ellipses, name: str) -> NDArray[np.float64]:
    """Parameters of each motion, shape (motions, others)."""
    if isinstance(ellipses, EllipseTable):
        values = ellipses.a if name == "a" else ellipses.b
    else:
        values = ellipses[name].transpose("motion", ...).values
    return values.reshape(values.shape[0], -1).astype(np.float64)
