"""Traced boundaries beside those that the exact responses predict."""

from collections.abc import Sequence
from itertools import product

import numpy as np
import xarray as xr

from reliab.boundary import DIRECTIONS, FirstOrderEllipse, predicted_ellipse, scales_of_contour
from reliab.progress import Progress, silent
from reliab.sweep.results_accessor import ResultsAccessor, contours_of

_OVER = ("motion", "f", "xi", "threshold", "side")


def compare_boundaries(
    results: xr.Dataset,
    measures: xr.Dataset,
    thresholds: Sequence[float],
    *,
    progress: Progress = silent,
) -> xr.Dataset:
    """Compare the boundaries of stored results with those that the exact responses predict.

    Parameters
    ----------
    results : xarray.Dataset
        Errors RMS^R of whole records over the grid of actuators, wholly experimental.
    measures : xarray.Dataset
        What :func:`measure_responses` returned for the same motions and structures.
    thresholds : sequence of float
        Errors on the boundaries [-].
    progress : callable, optional
        Called after each structure.

    Returns
    -------
    xarray.Dataset
        `measures` with `scale` [-] over (motion, f, xi, threshold, side), the largest multiple of a and b of
        the predicted ellipse that lies wholly inside the boundary, and `scale_towards` [-], in addition over
        the `direction` [degrees] in the ellipse's own angle, the multiple that reaches the boundary there.
    """
    accessor = ResultsAccessor(results)
    pairs = [(threshold, side) for threshold in thresholds for side in accessor.sides]
    sizes = [results.sizes[name] for name in ("motion", "f", "xi")]
    scales = np.full((*sizes, len(pairs), 1 + DIRECTIONS.size), np.nan)
    places = list(product(range(sizes[1]), range(sizes[2])))
    for count, (row, column) in enumerate(places, start=1):
        at = {"f": float(results["f"][row]), "xi": float(results["xi"][column])}
        structure, of_structure = accessor.structure(**at), measures.sel(at)
        contours = contours_of(accessor.at_structure(**at)["rms"], structure, pairs)
        for motion, of_motion in enumerate(contours):
            response = _response(of_structure.isel(motion=motion))
            scales[motion, row, column] = [
                scales_of_contour(contour, *predicted_ellipse(response, structure, *pair))
                for contour, pair in zip(of_motion, pairs, strict=True)
            ]
        progress(count, len(places))
    scales = scales.reshape(*sizes, len(thresholds), len(accessor.sides), -1)
    return measures.assign(
        {"scale": (_OVER, scales[..., 0]), "scale_towards": ((*_OVER, "direction"), scales[..., 1:])}
    ).assign_coords(
        threshold=list(thresholds),
        side=[str(side) for side in accessor.sides],
        direction=np.degrees(DIRECTIONS),
    )


def _response(measures: xr.Dataset) -> FirstOrderEllipse:
    """Response to one motion."""
    names = ("a_first", "b_first", "effective_duration", "duration")
    amplitude, delay, effective, duration = (float(measures[name]) for name in names)
    return FirstOrderEllipse(
        amplitude=amplitude, delay=delay, effective_duration=effective, duration=duration
    )
