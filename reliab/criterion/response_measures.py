"""What the exact responses to ground motions say of their boundaries, and how far traced ones lie from it."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.vocabulary import MILLI
from reliab.criterion.laws.law import scales
from reliab.tracking.boundary.finite_errors import DIRECTIONS, ratio_of_delays

if TYPE_CHECKING:
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
