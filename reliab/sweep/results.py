"""Stored results, opened and asked.

The accessor `dataset.reliab` answers the questions that people have of a results dataset: what the
error is in the cell nearest to a test, along a slice, between the cells, and where it reaches a
threshold.
"""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.boundary import Contour, Curve, trace_contours
from reliab.boundary.contour import REACH, furthest_lead
from reliab.boundary.surface import ErrorSurfaces
from reliab.errors import InputError
from reliab.files import decoding
from reliab.loop.structure import Structure
from reliab.progress import Progress, silent
from reliab.sweep.compact import open_compact
from reliab.sweep.ellipse_dataset import COLUMNS, CURVES, curve_row, ellipse_dataset
from reliab.sweep.labels import with_labels
from reliab.sweep.store import read_attributes
from reliab.vocabulary import RESULT_DIMENSIONS, Dimension, Metric, Side

_COORDINATES = ("motion", "f", "xi", "kp", "tau", "event", "duration", "dt", "pga", "checksum")
_AT_REST = "rms_at_rest"
_RULE = "Stored results must be as `reliab simulate` wrote them, with every checksum right"
_REMEDY = "Mend the store with `reliab simulate --resume`, or simulate again to another store"


def open_results(path: str | Path, *, window: str | None = None) -> xr.Dataset:
    """Open results that `reliab simulate` wrote.

    Parameters
    ----------
    path : str or pathlib.Path
        The Zarr store, or the NetCDF file that `write_compact` made of one.
    window : str, optional
        Which of the stored windows; the first by default.

    Returns
    -------
    xarray.Dataset
        `rms`, `mte`, `A` [-], `d` [s] and `stable` over (motion, f, xi, kp, tau), read from disk
        when they are asked for; of a NetCDF file `rms` and `mte`.

    Raises
    ------
    InputError
        If there is no such store or window, or not all motions are done.
    """
    path = Path(path)
    compact = None if path.is_dir() else open_compact(path)
    with decoding(_RULE, remedy=_REMEDY, where=path):
        stored = read_attributes(path)["windows"] if compact is None else compact.attrs["window"]
    windows = [str(label) for label in np.atleast_1d(np.asarray(stored))]
    window = window or windows[0]
    if window not in windows:
        raise InputError(
            "The window must be one that was stored",
            value=f"{window!r}, stored are {', '.join(windows)}",
            remedy="Choose one of these, or simulate with that window",
        )
    if compact is not None:
        return compact
    with decoding(_RULE, remedy=_REMEDY, where=path):
        return _stored(path, None if window == windows[0] else f"window_{window}")


def _stored(path: Path, group: str | None) -> xr.Dataset:
    """Open a group of a store, with the coordinates that every store has."""
    dataset = xr.open_zarr(path, group=group, consolidated=False, chunks=None)
    _ = float(dataset.attrs["experimental_fraction"]), dataset.attrs["study_hash"], dataset.attrs["window"]
    missing = int(np.isnan(dataset["duration"].values).sum())
    if missing:
        raise InputError(
            "A store must be complete before it is used",
            value=f"{missing} motions missing in {path}",
            remedy="Finish it with --resume",
        )
    # Strings of fixed width are what everyone can compare, save and group by.
    texts = {
        name: ("motion", np.array(dataset[name].values.tolist()), dataset[name].attrs)
        for name in ("motion", "event", "checksum")
    }
    plain = dataset.drop_vars(["journal", *texts], errors="ignore")
    opened: xr.Dataset = plain.assign_coords(texts).set_coords(_COORDINATES)
    return opened


@xr.register_dataset_accessor("reliab")  # type: ignore[no-untyped-call]
class ResultsAccessor:
    """Questions to a results dataset, as `dataset.reliab`."""

    def __init__(self, dataset: xr.Dataset) -> None:
        absent = [name for name in RESULT_DIMENSIONS if name not in dataset.dims]
        if absent or "rms" not in dataset:
            raise InputError(
                "The accessor 'reliab' belongs to a results dataset",
                value=f"a dataset without {', '.join(absent) or 'rms'}",
                remedy="Open one with reliab.open_results",
            )
        self._dataset = dataset

    def structure(self, f: float, xi: float) -> Structure:
        """Structure of the dataset with given natural frequency [Hz] and damping ratio [-].

        Parameters
        ----------
        f, xi : float
            They must be among the dataset's.

        Returns
        -------
        Structure
            The structure.

        Raises
        ------
        InputError
            If they are not among the dataset's.
        """
        for name, value in ((Dimension.FREQUENCY, f), (Dimension.DAMPING_RATIO, xi)):
            stored = self._dataset[name].values
            if not np.isclose(stored, value, rtol=1e-9).any():
                raise InputError(
                    f"{name} must be among the simulated ones, {', '.join(f'{x:g}' for x in stored)}",
                    value=value,
                    remedy="Choose one of these, or simulate that one",
                )
        fraction = float(self._dataset.attrs["experimental_fraction"])
        return Structure(frequency=f, damping_ratio=xi, experimental_fraction=fraction)

    def grid(self, f: float, xi: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Gains k_p [-] and delays τ [s] that were simulated for a structure.

        Parameters
        ----------
        f, xi : float
            Natural frequency [Hz] and damping ratio [-] of the dataset.

        Returns
        -------
        gains, delays : numpy.ndarray
            Shapes (kp,) and (tau,).
        """
        self.structure(f, xi)
        at = {
            Dimension.FREQUENCY: int(np.argmin(np.abs(self._dataset["f"].values - f))),
            Dimension.DAMPING_RATIO: int(np.argmin(np.abs(self._dataset["xi"].values - xi))),
        }
        gains, delays = (
            self._dataset[name].isel(
                {dim: index for dim, index in at.items() if dim in self._dataset[name].dims}
            )
            for name in (Dimension.GAIN, Dimension.DELAY)
        )
        with self._sound():
            return np.asarray(gains.values, dtype=np.float64), np.asarray(delays.values, dtype=np.float64)

    def _sound(self) -> AbstractContextManager[None]:
        """Explain damage to what is read from disk only now."""
        return decoding(_RULE, remedy=_REMEDY, where=self._dataset.encoding.get("source", ""))

    def at_structure(self, f: float, xi: float) -> xr.Dataset:
        """Results of one structure, as float64 with one-dimensional `kp` and `tau` coordinates.

        Parameters
        ----------
        f, xi : float
            Natural frequency [Hz] and damping ratio [-] of the dataset.

        Returns
        -------
        xarray.Dataset
            Over (motion, kp, tau).
        """
        gains, delays = self.grid(f, xi)
        chosen = self._dataset.drop_vars([Dimension.GAIN, Dimension.DELAY]).isel(
            {
                Dimension.FREQUENCY: int(np.argmin(np.abs(self._dataset["f"].values - f))),
                Dimension.DAMPING_RATIO: int(np.argmin(np.abs(self._dataset["xi"].values - xi))),
            }
        )
        with self._sound():
            chosen = chosen.load()
        floats = {name: values.astype(np.float64) for name, values in chosen.items() if name != "stable"}
        return with_labels(chosen.assign(floats).assign_coords(kp=gains, tau=delays))

    def nearest(self, *, f: float, xi: float, gain: float, delay: float) -> xr.Dataset:
        """Results of the cell that is nearest to given gain [-] and delay [s], over the motions.

        Parameters
        ----------
        f, xi : float
            Natural frequency [Hz] and damping ratio [-] of the dataset.
        gain, delay : float
            Actuator gain [-] and delay [s].

        Returns
        -------
        xarray.Dataset
            Over (motion,), with the cell's own `kp` and `tau`.
        """
        return self.at_structure(f, xi).sel(kp=gain, tau=delay, method="nearest")

    def errors(
        self,
        *,
        f: float,
        xi: float,
        gain: NDArray[np.float64],
        delay: NDArray[np.float64],
        metric: Metric = Metric.RMS,
    ) -> xr.DataArray:
        """Errors at given gains [-] and delays [s], between the cells, for every motion.

        Parameters
        ----------
        f, xi : float
            Natural frequency [Hz] and damping ratio [-] of the dataset.
        gain, delay : numpy.ndarray
            Actuator gains [-] and delays [s], shape (tests,).
        metric : Metric, optional
            RMS^R (default) or MTE^R.

        Returns
        -------
        xarray.DataArray
            Error [-] over (motion, test); NaN outside the grid.
        """
        results = self.at_structure(f, xi)
        motions, tests = results.sizes["motion"], np.size(gain)
        errors = _surfaces(results[metric]).error(
            np.tile(gain, motions), np.tile(delay, motions), np.repeat(np.arange(motions), tests)
        )
        return xr.DataArray(
            errors.reshape(motions, tests),
            dims=("motion", "test"),
            coords={"motion": results["motion"], "event": results["event"]},
            attrs=results[metric].attrs,
        )

    def contours(
        self,
        *,
        f: float,
        xi: float,
        threshold: float,
        metric: Metric = Metric.RMS,
        side: Side = Side.LAG,
    ) -> dict[str, Contour | None]:
        """Contour of equal error of each motion, on one side.

        Parameters
        ----------
        f, xi : float
            Natural frequency [Hz] and damping ratio [-] of the dataset.
        threshold : float
            Error on the contour [-].
        metric : Metric, optional
            RMS^R (default) or MTE^R.
        side : Side, optional
            Actuators that are late (default) or early.

        Returns
        -------
        dict of str to Contour or None
            By motion; None where the contour leaves the grid.

        Raises
        ------
        InputError
            If leads are asked for that were not simulated.
        """
        self._check_sides((side,))
        results = self.at_structure(f, xi)
        structure = self.structure(f, xi)
        contours = _trace(results[metric], structure, [(threshold, side)])
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
        """Curves that stand for the contours of every motion and structure, at any threshold.

        Parameters
        ----------
        thresholds : sequence of float, optional
            Errors on the contours [-].
        metrics : sequence of Metric, optional
            RMS^R, MTE^R or both.
        curves : sequence of type, optional
            Curves; the ellipse of least squares and the inscribed one by default.
        sides : sequence of Side, optional
            Actuators that are late, early, or both; by default all that were simulated.
        progress : callable, optional
            Called after each structure.

        Returns
        -------
        xarray.Dataset
            As `reliab.sweep.trace_ellipses` gives it, `a` [-] and `b` [ms²] over (motion, f, xi, threshold,
            metric, curve, side); NaN also where a contour leaves the grid.

        Raises
        ------
        InputError
            If leads are asked for that were not simulated.
        """
        sides = self.sides if sides is None else tuple(sides)
        self._check_sides(sides)
        sizes = [self._dataset.sizes[name] for name in ("motion", "f", "xi")]
        dims = (len(thresholds), len(metrics), len(curves), len(sides), len(COLUMNS))
        table = np.full((*sizes, *dims), np.nan)
        pairs = [(threshold, side) for threshold in thresholds for side in sides]
        total = sizes[1] * sizes[2]
        for i, f in enumerate(self._dataset["f"].values.tolist()):
            for j, xi in enumerate(self._dataset["xi"].values.tolist()):
                results, structure = self.at_structure(f, xi), self.structure(f, xi)
                for k, metric in enumerate(metrics):
                    contours = _trace(results[metric], structure, pairs)
                    rows = [
                        [[curve_row(contour, curve) for curve in curves] for contour in row]
                        for row in contours
                    ]
                    shape = sizes[0], len(thresholds), len(sides), len(curves), len(COLUMNS)
                    table[:, i, j, :, k] = np.reshape(rows, shape).swapaxes(2, 3)
                progress(i * sizes[2] + j + 1, total)
        kept = ("motion", "f", "xi", "event", "duration", "dt", "pga", "checksum")
        return ellipse_dataset(
            table,
            {name: self._dataset[name] for name in kept},
            thresholds=thresholds,
            metrics=metrics,
            curves=curves,
            sides=sides,
            attributes={
                name: self._dataset.attrs[name] for name in ("window", "experimental_fraction", "study_hash")
            },
            error_at_rest=self._at_rest(metrics),
        )

    @property
    def sides(self) -> tuple[Side, ...]:
        """Sides that were simulated: the lag, and the lead unless the store is of an older version."""
        leads = bool((self._dataset[Dimension.DELAY].values < 0.0).any())
        return tuple(Side) if leads else (Side.LAG,)

    def _check_sides(self, sides: Sequence[Side]) -> None:
        if not set(sides) <= set(self.sides):
            raise InputError(
                "Boundaries of leads need results with leads",
                value="results of delays only",
                remedy="Simulate again with leads, or ask for the side of the lag",
            )

    def _at_rest(self, metrics: Sequence[Metric]) -> NDArray[np.float64] | None:
        """Error of an actuator that does not move, shape (motion, f, xi, metric); None in older stores."""
        if _AT_REST not in self._dataset:
            return None
        rms = self._dataset[_AT_REST].transpose("motion", "f", "xi").values.astype(np.float64)
        # Nothing strays from the exact response by that response, whose peak is what MTE^R is relative to.
        by_metric = {Metric.RMS: rms, Metric.MTE: np.ones_like(rms)}
        return np.stack([by_metric[metric] for metric in metrics], axis=-1)


def _surfaces(errors: xr.DataArray) -> ErrorSurfaces:
    """Interpolate errors over (motion, kp, tau)."""
    return ErrorSurfaces(
        errors["kp"].values, errors["tau"].values, errors.transpose("motion", "kp", "tau").values
    )


def _trace(
    errors: xr.DataArray, structure: Structure, pairs: Sequence[tuple[float, Side]]
) -> list[list[Contour | None]]:
    """Contours by motion and pair of threshold and side; None where one leaves the grid."""
    surfaces = _surfaces(errors)
    motions = errors.sizes["motion"]
    levels = np.tile(np.array([threshold for threshold, _ in pairs], dtype=np.float64), motions)
    sides = [side for _ in range(motions) for _, side in pairs]
    surface = np.repeat(np.arange(motions), len(pairs))

    def error(
        amplitude: NDArray[np.float64], delay: NDArray[np.float64], contour: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        return surfaces.error(amplitude, delay, surface[contour])

    contours = trace_contours(error, levels, structure, side=sides)
    inside = np.stack([_inside_grid(errors, structure, *pair) for pair in pairs], axis=-1)
    chosen = [contour if ok else None for contour, ok in zip(contours, inside.ravel(), strict=True)]
    return [chosen[k : k + len(pairs)] for k in range(0, len(chosen), len(pairs))]


def _inside_grid(
    errors: xr.DataArray, structure: Structure, threshold: float, side: Side
) -> NDArray[np.bool_]:
    """Whether contours end before the grid does; shape (motion,)."""
    values = errors.transpose("motion", "kp", "tau").values
    delays, gains = errors["tau"].values, errors["kp"].values
    punctual = values[..., int(np.argmin(np.abs(delays)))]
    offset = np.abs(np.log(gains))
    reach = REACH * structure.damping_ratio * (1 - 1e-9)
    wide = (offset[[0, -1]] >= reach) | (punctual[:, [0, -1]] >= threshold)
    within = (offset <= reach) & (punctual < threshold)
    if side is Side.LEAD:
        followed = -delays[0] >= furthest_lead(structure, gains) * (1 - 1e-9)
        high = ~within | (values[..., 0] >= threshold) | followed
    else:
        high = ~within | (values[..., -1] >= threshold)
    return np.asarray(wide.all(axis=-1) & high.all(axis=-1))
