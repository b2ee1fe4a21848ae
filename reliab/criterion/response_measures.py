"""What exact responses to ground motions say of their boundaries; the ellipses of 100 motions that ship."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.files import decoding
from reliab.core.log_quantization import NEIGHBOURS, UNKNOWN, numbers_of
from reliab.core.shipped import shipped
from reliab.core.untrusted_files import open_hdf5
from reliab.core.vocabulary import MILLI, SHARE_ATTRIBUTE
from reliab.criterion.ellipse_table import CUT, DIMENSIONS, REST, CutRecords, EllipseTable, words_of
from reliab.criterion.laws.law import scales
from reliab.tracking.boundary.finite_errors import DIRECTIONS, ratio_of_delays

if TYPE_CHECKING:
    import h5py
    import xarray as xr

    from reliab.structures.structure import Structure
    from reliab.tracking.boundary.first_order import FirstOrderEllipse


Places = NDArray[np.int64]

_STRUCTURE_VARIABLES = ("a_first", "b_first", "effective_duration")


@dataclass(frozen=True, kw_only=True, eq=False)
class BoundaryScales:
    """Multiples of the predicted ellipses' a and b at which they reach the traced boundaries."""

    least: Array  # The largest ellipse inside, shape (motions, f, ξ, threshold, side)
    towards: (
        Array  # In addition over `reliab.tracking.boundary.finite_errors.DIRECTIONS`, all or some of them
    )
    thresholds: Array  # Errors on the boundaries [-], increasing
    sides: list[str]
    first_direction: int = 0  # Place of the first of `towards` among all directions

    def logarithms(self, threshold: float, side: str, angle: float | None) -> Array:
        """Logarithms at an error, shape (motions, f, ξ); of the whole boundary, or towards an angle [rad].

        Between stored errors they are linear in the logarithm of the error.
        """
        side_index = self.sides.index(side)
        if angle is None:
            scale = self.least[..., side_index]
        else:
            lower, weights = directions_about(angle)
            near = slice(lower - self.first_direction, lower - self.first_direction + 2)
            scale = np.exp(np.log(self.towards[..., side_index, near]) @ weights)
        logarithms, errors = np.log(scale), np.log(self.thresholds)
        upper = int(np.clip(np.searchsorted(errors, np.log(threshold) - 1e-9), 1, errors.size - 1))
        share = float(np.clip((np.log(threshold) - errors[upper - 1]) / np.diff(errors)[upper - 1], 0.0, 1.0))
        if share in (0.0, 1.0):  # NaN at the other error says nothing of this one
            return np.asarray(logarithms[..., upper - 1 + int(share)])
        return np.asarray((1.0 - share) * logarithms[..., upper - 1] + share * logarithms[..., upper])


def directions_about(angle: float) -> tuple[int, Array]:
    """Place of the first of the two directions about an angle [rad], and the weights of both."""
    place = np.clip(angle / DIRECTIONS[1], 0.0, DIRECTIONS.size - 1.0)
    lower_index = min(int(place), DIRECTIONS.size - 2)
    return lower_index, np.array([1.0 - place + lower_index, place - lower_index])


@dataclass(frozen=True, kw_only=True, eq=False)
class ResponseMeasures:
    """Measures of responses to ground motions, in plain arrays."""

    a_first: Array  # Ellipse parameter of the amplitude over the squared error [-], shape (motions, f, ξ)
    b_first: Array  # The same of the delay [ms²]
    effective_duration: Array  # ∫x²dt/max x² [s]
    motions: NDArray[Any]  # Names, shape (motions,)
    duration: Array  # Length of the records [s], shape (motions,)
    frequencies: Array  # [Hz], shape (f,)
    damping_ratios: Array  # [-], shape (ξ,)
    scales: BoundaryScales | None = None  # Where boundaries were traced and compared

    @classmethod
    def from_dataset(cls, measures: "xr.Dataset") -> Self:
        """Take the arrays of what `measure_responses` returned, and multiples where there are any."""
        axes = ("motion", "f", "xi")
        scales_of = None
        if "scale" in measures:
            scales_of = BoundaryScales(
                least=measures["scale"].transpose(*axes, "threshold", "side").values,
                towards=measures["scale_towards"].transpose(*axes, "threshold", "side", "direction").values,
                thresholds=measures["threshold"].values.astype(np.float64),
                sides=[str(side) for side in measures["side"].values],
            )
        return cls(
            **{name: measures[name].transpose(*axes).values for name in _STRUCTURE_VARIABLES},
            motions=measures["motion"].values,
            duration=measures["duration"].values,
            frequencies=measures["f"].values.astype(np.float64),
            damping_ratios=measures["xi"].values.astype(np.float64),
            scales=scales_of,
        )

    @classmethod
    def from_response(cls, response: "FirstOrderEllipse", structure: "Structure", name: str) -> Self:
        """Measures of the response of one structure, shape (1, 1, 1)."""
        return cls(
            a_first=np.full((1, 1, 1), response.amplitude),
            b_first=np.full((1, 1, 1), response.delay),
            effective_duration=np.full((1, 1, 1), response.effective_duration),
            motions=np.array([name]),
            duration=np.array([response.duration]),
            frequencies=np.array([structure.frequency]),
            damping_ratios=np.array([structure.damping_ratio]),
        )

    @property
    def measure_values(self) -> dict[str, Array]:
        """Quantities by which a response is compared with others, shape (motions, f, ξ) each.

        `effective_duration` [s]; `frequency_ratio`, the frequency of the error over that of the structure
        [-], which is 1 at resonance; `sensitivity`, the RMS^R for an amplitude error as large as the damping
        ratio, in the limit of small errors [-].
        """
        f, xi = self.frequencies.reshape(-1, 1), self.damping_ratios.reshape(1, -1)
        return {
            "effective_duration": self.effective_duration,
            "frequency_ratio": MILLI * np.sqrt(self.a_first / self.b_first) / (2.0 * np.pi * f),
            "sensitivity": xi / np.sqrt(self.a_first),
        }

    def take(self, motions: Any) -> Self:  # noqa: ANN401 - whatever takes places of an array
        """Take some of the motions."""
        names = (*_STRUCTURE_VARIABLES, "motions", "duration")
        scales = self.scales
        if scales is not None:
            scales = replace(scales, least=scales.least[motions], towards=scales.towards[motions])
        return replace(self, **{name: getattr(self, name)[motions] for name in names}, scales=scales)

    def select_structures(self, f: Places, xi: Places) -> Self:
        """Take some of the structures, by their places along either axis; without their boundaries."""
        return replace(
            self,
            **{name: getattr(self, name)[:, *np.ix_(f, xi)] for name in _STRUCTURE_VARIABLES},
            frequencies=self.frequencies[f],
            damping_ratios=self.damping_ratios[xi],
            scales=None,
        )

    def nearest(self, frequencies: Array, damping_ratios: Array) -> tuple[Places, Places]:
        """Places of the structures nearest to others, along either axis."""
        return _nearest(self.frequencies, frequencies), _nearest(self.damping_ratios, damping_ratios)

    def predict_ellipses(self, threshold: float, side: str) -> tuple[Array, Array, Array]:
        """Predicted a [-], b [ms²] and dimensionless size of an error, shape (motions, f, ξ)."""
        unit = scales(self.frequencies.reshape(-1, 1), self.damping_ratios.reshape(1, -1))[1]
        size = threshold * np.sqrt(self.b_first / unit)
        a, b = threshold**2 * self.a_first, threshold**2 * self.b_first
        return a, b * ratio_of_delays(size, side) ** 2, size


def _nearest(values: Array, targets: Array) -> Places:
    """Places of the nearest values; the larger one of two as near."""
    distance = np.abs(values[::-1] - np.asarray(targets)[:, np.newaxis])
    return np.asarray(values.size - 1 - distance.argmin(axis=1))


_ELLIPSES, _MEASURES = "real_suite/ellipses.nc", "real_suite/first_order.nc"
_NO_SELECTION: Final[Mapping[str, slice]] = MappingProxyType({})


@cache
def read_shipped_ellipses(curve: str, window: str, metric: str) -> EllipseTable:
    """Ellipses of one kind that ship, of one error over one of the windows."""
    with _open_shipped(_ELLIPSES, "Ellipses") as file:
        coordinates = {name: _values(file, name) for name in DIMENSIONS}
        selection = {"window": window, "curve": curve, "metric": metric}
        place = {name: _values(file, name).tolist().index(label) for name, label in selection.items()}
        part = {name: slice(row, row + 1) for name, row in place.items()}
        return EllipseTable(
            **{name: _numbers(file, name, part)[0] for name in ("a", "b")},
            coordinates=coordinates | {name: coordinates[name][part[name]] for name in ("curve", "metric")},
            motion_values={
                name: _values(file, name) for name in ("event", "duration", "checksum", "outline")
            },
            error_at_rest=file[REST][place["window"]][..., part["metric"]],
            cut_records=_cut_records(file) if window == "record" else None,
            attrs={SHARE_ATTRIBUTE: float(file.attrs[SHARE_ATTRIBUTE][0]), "window": window},
            words=words_of(),
        )


def _cut_records(file: "h5py.File") -> CutRecords:
    ratios = np.stack([file[name][()].astype(np.float64) for name in CUT], axis=-1)
    return CutRecords(lengths=_values(file, "length").astype(np.float64), ratios=ratios)


def read_shipped_measures(angle: float | None = None) -> ResponseMeasures:
    """Measures of the responses to the motions of the ellipses that ship.

    `angle` [rad]: the direction in which boundaries will be compared, if in one alone.
    """
    measures = _measures()
    if angle is None or measures.scales is None:
        return measures
    first = directions_about(angle)[0]
    scales = replace(measures.scales, towards=_towards(first), first_direction=first)
    return replace(measures, scales=scales)


@cache
def _measures() -> ResponseMeasures:
    """Read all but the multiples towards directions, of which most questions need none."""
    with _open_shipped(_MEASURES, "Measures of responses") as file:
        return ResponseMeasures(
            **{name: file[name][()] for name in ("a_first", "b_first", "effective_duration", "duration")},
            motions=_values(file, "motion"),
            frequencies=file["f"][()],
            damping_ratios=file["xi"][()],
            scales=BoundaryScales(
                least=_numbers(file, "scale"),
                towards=_numbers(file, "scale_towards", {"direction": slice(0)}),
                thresholds=file["threshold"][()],
                sides=_values(file, "side").tolist(),
            ),
        )


@cache
def _towards(first: int) -> NDArray[Any]:
    """Read the multiples towards a direction and the next."""
    with _open_shipped(_MEASURES, "Measures of responses") as file:
        return _numbers(file, "scale_towards", {"direction": slice(first, first + 2)})


@contextmanager
def _open_shipped(name: str, words: str) -> Iterator["h5py.File"]:
    """Open a file that ships; `words`: what it holds."""
    path, rule = shipped("datasets", name), f"{words} must be a NetCDF file"
    remedy = "Install the package again"
    with decoding(rule, remedy=remedy, where=path), open_hdf5(path, ships=True) as file:
        yield file


def _numbers(file: "h5py.File", name: str, part: Mapping[str, slice] = _NO_SELECTION) -> NDArray[Any]:
    """Read numbers that are stored in steps of their logarithm, or a part of them along some dimensions.

    Numbers are told by those before them: along neighbours one place is read with all before it.
    """
    dataset = file[name]
    dimensions = [str(scale[0].name).rpartition("/")[2] for scale in dataset.dims]
    selection = {dimension: part.get(dimension, slice(None)) for dimension in dimensions}
    neighbours = dataset.attrs[NEIGHBOURS].split()
    read = tuple(slice(index.stop) if name in neighbours else index for name, index in selection.items())
    numbers = numbers_of(dataset[read], dataset.attrs, dimensions, last=list(part))
    unknown = file[dataset.attrs[UNKNOWN]]
    unknown_values = unknown[tuple(selection.values())[: unknown.ndim]]
    is_known = unknown_values.reshape(unknown_values.shape + (1,) * (dataset.ndim - unknown.ndim)) == 0
    return np.where(is_known, numbers, np.float32(np.nan))


def _values(file: "h5py.File", name: str) -> NDArray[Any]:
    """Numbers or texts along a dimension."""
    values = file[name]
    return np.array(values.asstr()[()].tolist(), dtype=np.str_) if values.dtype.kind == "O" else values[()]
