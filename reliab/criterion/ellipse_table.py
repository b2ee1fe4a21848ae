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

_OF_FIRST_ORDER = 0.01
"""Error below which a and b of the ellipses that ship are proportional to its square, within 3 % (median)."""

_Table = TypeVar("_Table", bound="EllipseTable")
DIMENSIONS = tuple(str(name) for name in ELLIPSE_DIMENSIONS)
_OF_REST = ("motion", "f", "xi", "metric")
_OF_CUT = ("motion", "f", "xi", "length")
_OF_OLDER_FILES = {"curve": str(CurveName.ELLIPSE), "side": str(Side.LAG)}


@dataclass(frozen=True, kw_only=True, eq=False)
class CutRecords:
    """How a and b of RMS^R of whole records change when the records are cut."""

    lengths: Array  # [s], shape (lengths,), increasing
    ratios: Array  # a and b over those of the whole records [-], shape (motions, f, ξ, lengths, 2)

    def at(self, length: float) -> Array:
        """Ratios at a length [s], shape (motions, f, ξ, 2).

        Between lengths their logarithms are linear in that of the length; beyond the ends they stay.
        """
        length = float(np.clip(length, self.lengths[0], self.lengths[-1]))
        above = int(np.clip(np.searchsorted(self.lengths, length), 1, self.lengths.size - 1))
        low, high = np.log(self.lengths[above - 1 : above + 1])
        weight = (np.log(length) - low) / (high - low)
        below, beyond = (np.log(self.ratios[..., place, :]) for place in (above - 1, above))
        return np.asarray(np.exp((1.0 - weight) * below + weight * beyond))


@dataclass(frozen=True, kw_only=True, eq=False)
class EllipseTable:
    """Ellipses of ground motions over structures and errors, of one share of the stiffness."""

    # a, b: Parameters [-] and [ms²], shape (motion, f, xi, threshold, metric, curve, side)
    a: Array
    b: Array
    at: Mapping[str, NDArray[Any]]  # Values along each dimension, by its name
    # `event` of each motion, and where they are known `duration` [s] and `checksum`
    of_motions: Mapping[str, NDArray[Any]]
    error_at_rest: Array | None = None  # [-], shape (motion, f, xi, metric)
    cut_records: CutRecords | None = None  # Of whole records, where these were at hand
    attrs: Mapping[str, Any] = field(default_factory=dict)  # Window, share of the stiffness, and the like
    words: Mapping[str, str] = field(default_factory=dict)  # What dimensions are called in sentences

    @classmethod
    def from_dataset(cls, ellipses: "xr.Dataset") -> Self:
        """Take the arrays of a dataset; one without curves or sides is of fitted ellipses and of lags.

        Raises InputError if it is of several shares of the stiffness.
        """
        from reliab.sweep.shares import at_share

        ellipses = at_share(ellipses)
        lacking = [name for name in _OF_OLDER_FILES if name not in ellipses.dims]
        given = [name for name in DIMENSIONS if name not in lacking]
        axes = tuple(DIMENSIONS.index(name) for name in lacking)
        a, b = (np.expand_dims(ellipses[name].transpose(*given).values, axes).view() for name in ("a", "b"))
        return cls(
            a=a,
            b=b,
            at={
                **{name: ellipses[name].values for name in given},
                **{name: np.array(names_along(ellipses, name)) for name in lacking},
            },
            of_motions={
                str(name): part.values
                for name, part in ellipses.coords.items()
                if part.dims == ("motion",) and name != "motion"
            },
            error_at_rest=ellipses[REST].transpose(*_OF_REST).values if REST in ellipses else None,
            cut_records=_cut_records(ellipses),
            attrs={str(name): value for name, value in ellipses.attrs.items()},
            words={
                name: str(ellipses[name].attrs.get("long_name", name))
                for name in given
                if name in ellipses.coords
            },
        )

    def to_dataset(self, like: "xr.Dataset | None" = None) -> "xr.Dataset":
        """Put the arrays into a dataset whose variables are described as those of another one."""
        import xarray as xr

        variables: dict[str, Any] = {"a": (DIMENSIONS, self.a), "b": (DIMENSIONS, self.b)}
        coordinates: dict[str, Any] = {name: ("motion", values) for name, values in self.of_motions.items()}
        if self.cut_records is not None:
            coordinates["length"] = self.cut_records.lengths
            ratios = np.moveaxis(self.cut_records.ratios, -1, 0)
            variables |= {name: (_OF_CUT, ratio) for name, ratio in zip(CUT, ratios, strict=True)}
        if self.error_at_rest is not None:
            variables[REST] = (_OF_REST, self.error_at_rest)
        whole = xr.Dataset(variables, coords={**self.at, **coordinates}, attrs=dict(self.attrs))
        for name in whole.variables if like is not None else ():
            if like is not None and name in like.variables:
                whole[name].attrs.update(like[name].attrs)
        return whole

    @property
    def share(self) -> float:
        """Share of the stiffness in the laboratory [-]."""
        return float(self.attrs.get(SHARE_ATTRIBUTE, 1.0))

    @property
    def events(self) -> NDArray[Any]:
        """Earthquake of each motion, shape (motions,)."""
        return self.of_motions["event"]

    @property
    def n_motions(self) -> int:
        """Number of motions."""
        return int(self.a.shape[0])

    def take(self, **places: ArrayLike) -> Self:
        """Take places along dimensions, which all stay."""
        a, b, rest, cut = self.a, self.b, self.error_at_rest, self.cut_records
        at, of_motions = dict(self.at), dict(self.of_motions)
        for name, given in places.items():
            chosen = np.asarray(given)
            chosen = np.flatnonzero(chosen) if chosen.dtype == np.bool_ else chosen
            axis = DIMENSIONS.index(name)
            a, b = np.take(a, chosen, axis), np.take(b, chosen, axis)
            at[name] = at[name][chosen]
            if rest is not None and name in _OF_REST:
                rest = np.take(rest, chosen, _OF_REST.index(name))
            if cut is not None and name in _OF_CUT:
                cut = replace(cut, ratios=np.take(cut.ratios, chosen, _OF_CUT.index(name)))
            if name == Dimension.MOTION:
                of_motions = {label: values[chosen] for label, values in of_motions.items()}
        return replace(self, a=a, b=b, at=at, of_motions=of_motions, error_at_rest=rest, cut_records=cut)

    def sorted_by(self, *names: str) -> Self:
        """Put the values of dimensions into increasing order."""
        return self.take(**{name: np.argsort(self.at[name], kind="stable") for name in names})

    def at_threshold(self, threshold: float) -> Self:
        """Ellipses of one error [-].

        Between two errors of this table ln a and ln b are linear in the logarithm of the error. Below its
        smallest one, if that is 1 % or less, a and b are proportional to the square of the error.
        """
        stored = self.at["threshold"].astype(np.float64)
        low, high = float(stored.min()), float(stored.max())
        if np.isclose(stored, threshold, rtol=1e-9, atol=0.0).any():
            return self.take(threshold=neighbours(stored, threshold))
        if not 0.0 < threshold <= high or (threshold < low and low > _OF_FIRST_ORDER * (1.0 + 1e-9)):
            raise InputError(
                f"The ellipses were not traced for this {self.words.get('threshold', 'threshold')}",
                value=f"{threshold:g}",
                remedy=f"Choose among {', '.join(f'{value:g}' for value in stored)} or between them, or "
                "trace boundaries of this error with `reliab ellipses --motions`",
            )
        near = self.take(threshold=neighbours(stored, threshold))
        if threshold < low:
            smaller = (threshold / low) ** 2
            near = replace(near, a=near.a * smaller, b=near.b * smaller)
        else:
            below, above = (near.take(threshold=[place]) for place in (0, 1))
            places = np.log(near.at["threshold"].astype(np.float64))
            near = between_tables(below, above, float((np.log(threshold) - places[0]) / np.ptp(places)))
        return replace(near, at={**near.at, "threshold": np.array([threshold])})

    def stating(self, **attrs: object) -> Self:
        """Note attributes beside those that are there."""
        return replace(self, attrs={**self.attrs, **attrs})


def _cut_records(ellipses: "xr.Dataset") -> CutRecords | None:
    if any(name not in ellipses for name in CUT):
        return None
    ratios = [ellipses[name].transpose(*_OF_CUT).values.astype(np.float64) for name in CUT]
    return CutRecords(lengths=ellipses["length"].values.astype(np.float64), ratios=np.stack(ratios, axis=-1))


def neighbours(values: NDArray[Any], wanted: float) -> NDArray[np.int64]:
    """Places of one stored value, or of the two on either side in increasing order.

    >>> neighbours(np.array([0.2, 0.1, 0.05]), 0.12), neighbours(np.array([0.2, 0.1]), 0.3)
    (array([1, 0]), array([0]))
    """
    order = np.argsort(values)
    ordered = values[order].astype(np.float64)
    place = int(np.clip(np.searchsorted(ordered, wanted * (1.0 - 1e-9)), 0, ordered.size - 1))
    if np.isclose(ordered[place], wanted, rtol=1e-9) or wanted < ordered[0] or wanted > ordered[-1]:
        return order[place : place + 1]
    return order[place - 1 : place + 1]


def between_tables(below: _Table, above: _Table, weight: float) -> _Table:
    """Ellipses between two tables, ln a and ln b being linear in the weight of the second."""
    (a_low, b_low), (a_high, b_high) = _logarithms(below), _logarithms(above)
    share = 1.0 - weight
    return replace(
        above,
        a=np.exp(share * a_low + weight * a_high),
        b=np.exp(share * b_low + weight * b_high),
    )


def _logarithms(table: EllipseTable) -> tuple[Array, Array]:
    """Logarithms of a and b; NaN where a motion has no ellipse."""
    sound = (table.a > 0.0) & (table.b > 0.0)
    return np.log(np.where(sound, table.a, np.nan)), np.log(np.where(sound, table.b, np.nan))


def tabled(ellipses: Ellipses) -> EllipseTable:
    """Take the arrays of ellipses with labels."""
    return ellipses if isinstance(ellipses, EllipseTable) else EllipseTable.from_dataset(ellipses)


def with_threshold(ellipses: "xr.Dataset", threshold: float) -> "xr.Dataset":
    """Ellipses that hold an error [-], stored or as :meth:`EllipseTable.at_threshold` finds it."""
    if np.isclose(ellipses["threshold"].values, threshold, rtol=1e-9, atol=0.0).any():
        return ellipses
    found = EllipseTable.from_dataset(ellipses).at_threshold(threshold).to_dataset(like=ellipses)
    return found.assign({name: ellipses[name] for name in (REST,) if name in ellipses})


def names_along(ellipses: Ellipses, name: str) -> list[str]:
    """List the names along `curve`, `side` or `metric`; older files hold fitted ellipses of lags."""
    if isinstance(ellipses, EllipseTable):
        return [str(value) for value in ellipses.at[name]]
    if name in ellipses.coords:
        return [str(value) for value in np.atleast_1d(ellipses[name].values)]
    return [_OF_OLDER_FILES[name]]


def words_of(names: Sequence[str] = DIMENSIONS) -> dict[str, str]:
    """Say what dimensions are called in sentences."""
    return {name: LABELS[name].long_name for name in names}


_Given = TypeVar("_Given", "xr.Dataset", EllipseTable)

_WRITTEN_OUT = 2  # copies that a sentence names
_SAME = 2e-4  # difference of ln a and ln b that rounding and tracing leave between a record and its copy


def without_copies(ellipses: _Given) -> _Given:
    """Let each record count once, and note as `copies` which motions were left out."""
    first = copied_from(ellipses)
    copied = np.flatnonzero(first != np.arange(first.size))
    if not copied.size:
        return ellipses
    names = _motion_texts(ellipses, "motion")
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
    checksums, outlines = (_motion_texts(ellipses, name) for name in ("checksum", "outline"))
    if checksums.size and all(checksums.tolist()):
        alike |= checksums[:, None] == checksums
    if outlines.size and all(outlines.tolist()):
        alike |= are_copies(outlines, outlines)
    return np.asarray(alike.argmax(axis=1))


def _motion_texts(ellipses: Ellipses, name: str) -> NDArray[np.str_]:
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
