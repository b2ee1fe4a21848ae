"""Evaluation of stored results by the accessor `dataset.reliab`: errors, contours, ellipses."""

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.files import decoding
from reliab.core.progress import Progress, silent
from reliab.core.vocabulary import RESULT_DIMENSIONS, SHARE_ATTRIBUTE, Dimension, Metric, Side
from reliab.structures.structure import Structure
from reliab.sweep.cut_records import add_known_cut_records
from reliab.sweep.ellipse_dataset import COLUMNS, CURVES, curve_table, ellipse_dataset
from reliab.sweep.labels import concatenate_shares, label_variables, select_share, share_of, shares_of
from reliab.sweep.store_layout import MEND, STORED_RULE
from reliab.tracking.boundary.contour import REACH, Contour, ErrorSurfaces, furthest_lead, trace_contours
from reliab.tracking.boundary.curves import Curve

_MOTIONS_AT_A_TIME = 32  # motions


def batches(motions: int) -> Iterator[slice]:
    """Divide motions into some at a time, so that memory does not grow with their number.

    >>> [(some.start, some.stop) for some in batches(70)]
    [(0, 32), (32, 64), (64, 70)]
    """
    for begin in range(0, motions, _MOTIONS_AT_A_TIME):
        yield slice(begin, min(begin + _MOTIONS_AT_A_TIME, motions))


def surfaces_of(errors: xr.DataArray) -> ErrorSurfaces:
    """Interpolate the errors of a dataset between its gains and delays.

    `errors` [-].
    """
    return ErrorSurfaces(
        errors["kp"].values, errors["tau"].values, errors.transpose("motion", "kp", "tau").values
    )


def contours_of(
    errors: xr.DataArray, structure: Structure, pairs: Sequence[tuple[float, Side]]
) -> list[list[Contour | None]]:
    """Contours of equal error of every motion.

    `errors`, `pairs` [-].
    """
    surfaces = surfaces_of(errors)
    motions = errors.sizes["motion"]
    levels = np.tile(np.array([threshold for threshold, _ in pairs], dtype=np.float64), motions)
    sides = [side for _ in range(motions) for _, side in pairs]
    surface = np.repeat(np.arange(motions), len(pairs))

    def error(amplitude: Array, delay: Array, contour: NDArray[np.int64]) -> Array:
        return surfaces.error(amplitude, delay, surface[contour])

    contours = trace_contours(error, levels, structure, side=sides)
    is_inside = np.stack([_ends_inside_grid(errors, structure, *pair) for pair in pairs], axis=-1)
    contours_on_grid = [
        contour if ok else None for contour, ok in zip(contours, is_inside.ravel(), strict=True)
    ]
    return [contours_on_grid[k : k + len(pairs)] for k in range(0, len(contours_on_grid), len(pairs))]


def _ends_inside_grid(
    errors: xr.DataArray, structure: Structure, threshold: float, side: Side
) -> NDArray[np.bool_]:
    """Whether contours end before the grid does; shape (motion,)."""
    values = errors.transpose("motion", "kp", "tau").values
    delays, gains = errors["tau"].values, errors["kp"].values
    punctual = values[..., int(np.argmin(np.abs(delays)))]
    offset = np.abs(np.log(gains))
    reach = REACH * structure.damping_ratio * (1 - 1e-9)
    wide = (offset[[0, -1]] >= reach) | (punctual[:, [0, -1]] >= threshold)
    is_within = (offset <= reach) & (punctual < threshold)
    if side is Side.LEAD:
        is_at_furthest_lead = -delays[0] >= furthest_lead(structure, gains) * (1 - 1e-9)
        high = ~is_within | (values[..., 0] >= threshold) | is_at_furthest_lead
    else:
        high = ~is_within | (values[..., -1] >= threshold)
    return np.asarray(wide.all(axis=-1) & high.all(axis=-1))


def errors_at_rest(results: xr.Dataset, metrics: Sequence[Metric]) -> Array | None:
    """Error of an actuator that does not move.

    Returns error [-], shape (motion, f, xi, metric); None where the results are of an older version.
    """
    if "rms_at_rest" not in results:
        return None
    rms = results["rms_at_rest"].transpose("motion", "f", "xi").values.astype(np.float64)
    # Without motion the deviation is the exact response, whose peak normalises MTE^R, so that MTE^R is 1.
    errors_of_metric = {Metric.RMS: rms, Metric.MTE: np.ones_like(rms)}
    return np.stack([errors_of_metric[metric] for metric in metrics], axis=-1)


_KEPT_COORDINATES = ("motion", "f", "xi", "event", "duration", "dt", "pga", "checksum")


@xr.register_dataset_accessor("reliab")  # type: ignore[no-untyped-call]
class ResultsAccessor:
    """Methods of a results dataset, available as `dataset.reliab`."""

    def __init__(self, dataset: xr.Dataset) -> None:
        absent = [name for name in RESULT_DIMENSIONS if name not in dataset.dims]
        if absent or "rms" not in dataset:
            raise InputError(
                "The accessor 'reliab' works on a results dataset only",
                value=f"a dataset without {', '.join(absent) or 'rms'}",
                remedy="Open one with reliab.open_results",
            )
        self._dataset = select_share(dataset) if len(shares_of(dataset)) == 1 else dataset

    def structure(self, f: float, xi: float) -> Structure:
        """Structure of the dataset with given natural frequency [Hz] and damping ratio [-]."""
        for name, value in ((Dimension.FREQUENCY, f), (Dimension.DAMPING_RATIO, xi)):
            values = self._dataset[name].values
            if not np.isclose(values, value, rtol=1e-9).any():
                raise InputError(
                    f"{name} must be among the simulated ones, {', '.join(f'{x:g}' for x in values)}",
                    value=value,
                    remedy="Choose one of these, or simulate that one",
                )
        return Structure(frequency=f, damping_ratio=xi, experimental_fraction=share_of(self._dataset))

    def grid(self, f: float, xi: float) -> tuple[Array, Array]:
        """Gains k_p [-] and delays τ [s] that were simulated for a structure."""
        self.structure(f, xi)
        structure_place = {
            Dimension.FREQUENCY: int(np.argmin(np.abs(self._dataset["f"].values - f))),
            Dimension.DAMPING_RATIO: int(np.argmin(np.abs(self._dataset["xi"].values - xi))),
        }
        gains, delays = (
            self._dataset[name].isel(
                {dim: index for dim, index in structure_place.items() if dim in self._dataset[name].dims}
            )
            for name in (Dimension.GAIN, Dimension.DELAY)
        )
        with self._sound():
            return np.asarray(gains.values, dtype=np.float64), np.asarray(delays.values, dtype=np.float64)

    def _sound(self) -> AbstractContextManager[None]:
        """Turn damage found while reading from disk into an error for the user."""
        return decoding(STORED_RULE, remedy=MEND, where=self._dataset.encoding.get("source", ""))

    def select_structure(self, f: float, xi: float) -> xr.Dataset:
        """Results of one structure, as float64 with one-dimensional `kp` and `tau` coordinates."""
        gains, delays = self.grid(f, xi)
        results = self._dataset.drop_vars([Dimension.GAIN, Dimension.DELAY]).isel(
            {
                Dimension.FREQUENCY: int(np.argmin(np.abs(self._dataset["f"].values - f))),
                Dimension.DAMPING_RATIO: int(np.argmin(np.abs(self._dataset["xi"].values - xi))),
            }
        )
        with self._sound():
            results = results.load()
        floats = {name: values.astype(np.float64) for name, values in results.items() if name != "stable"}
        return label_variables(results.assign(floats).assign_coords(kp=gains, tau=delays))

    def nearest(self, *, f: float, xi: float, gain: float, delay: float) -> xr.Dataset:
        """Results of the cell nearest to a given gain [-] and delay [s], for every motion."""
        return self.select_structure(f, xi).sel(kp=gain, tau=delay, method="nearest")

    def errors(
        self, *, f: float, xi: float, gain: Array, delay: Array, metric: Metric = Metric.RMS
    ) -> xr.DataArray:
        """Errors at given gains [-] and delays [s], between the cells, for every motion.

        Returns [-].
        """
        results = self.select_structure(f, xi)
        motions, tests = results.sizes["motion"], np.size(gain)
        errors = surfaces_of(results[metric]).error(
            np.tile(gain, motions), np.tile(delay, motions), np.repeat(np.arange(motions), tests)
        )
        return xr.DataArray(
            errors.reshape(motions, tests),
            dims=("motion", "test"),
            coords={"motion": results["motion"], "event": results["event"]},
            attrs=results[metric].attrs,
        )

    def contours(
        self, *, f: float, xi: float, threshold: float, metric: Metric = Metric.RMS, side: Side = Side.LAG
    ) -> dict[str, Contour | None]:
        """Contour of equal error of each motion, on one side.

        `threshold` [-].
        """
        self._check_sides((side,))
        results = self.select_structure(f, xi)
        contours = contours_of(results[metric], self.structure(f, xi), [(threshold, side)])
        return dict(zip(results["motion"].values.tolist(), (contour[0] for contour in contours), strict=True))

    def ellipses(
        self,
        thresholds: Sequence[float] = (0.05,),
        metrics: Sequence[Metric] = (Metric.RMS,),
        curves: Sequence[type[Curve]] = CURVES,
        *,
        sides: Sequence[Side] | None = None,
        progress: Progress = silent,
    ) -> xr.Dataset:
        """Curves fitted to the contours of every motion and structure, at any threshold.

        `thresholds` [-].
        Returns what `reliab.sweep.ellipse_table.trace_ellipses` does: `a` [-] and `b` [ms²] over (motion, f,
        xi, threshold, metric, curve, side), with `alpha` after `xi` where the results have several shares;
        NaN also where a contour leaves the grid.
        """
        sides = self.sides if sides is None else tuple(sides)
        self._check_sides(sides)
        if len(shares := shares_of(self._dataset)) > 1:

            def trace_share(share: float, advance: Progress) -> xr.Dataset:
                accessor = ResultsAccessor(select_share(self._dataset, share))
                return accessor.ellipses(thresholds, metrics, curves, sides=sides, progress=advance)

            return concatenate_shares(shares, trace_share, progress)
        sizes = [self._dataset.sizes[name] for name in ("motion", "f", "xi")]
        table = np.full(
            (*sizes, len(thresholds), len(metrics), len(curves), len(sides), len(COLUMNS)), np.nan
        )
        pairs = [(threshold, side) for threshold in thresholds for side in sides]
        total = sizes[1] * sizes[2]
        for i, f in enumerate(self._dataset["f"].values.tolist()):
            for j, xi in enumerate(self._dataset["xi"].values.tolist()):
                structure = self.structure(f, xi)
                for batch in batches(sizes[0]):
                    results = ResultsAccessor(self._dataset.isel(motion=batch)).select_structure(f, xi)
                    for k, metric in enumerate(metrics):
                        rows = curve_table(contours_of(results[metric], structure, pairs), curves)
                        rows_of_side = rows.reshape(-1, len(thresholds), len(sides), *rows.shape[2:])
                        table[batch, i, j, :, k] = rows_of_side.swapaxes(2, 3)
                progress(i * sizes[2] + j + 1, total)
        ellipses = ellipse_dataset(
            table,
            {name: self._dataset[name] for name in _KEPT_COORDINATES},
            thresholds=thresholds,
            metrics=metrics,
            curves=curves,
            sides=sides,
            attributes={
                name: self._dataset.attrs[name] for name in ("window", SHARE_ATTRIBUTE, "study_hash")
            },
            error_at_rest=errors_at_rest(self._dataset, metrics),
        )
        return add_known_cut_records(ellipses)

    @property
    def sides(self) -> tuple[Side, ...]:
        """Sides that were simulated: the lag, and the lead unless the store is of an older version."""
        leads = bool((self._dataset[Dimension.DELAY].values < 0.0).any())
        return tuple(Side) if leads else (Side.LAG,)

    def _check_sides(self, sides: Sequence[Side]) -> None:
        if not set(sides) <= set(self.sides):
            raise InputError(
                "These results hold no early actuators (leads)",
                value="results of delays only",
                remedy="Simulate again with leads, or ask for the side of the lag",
            )
