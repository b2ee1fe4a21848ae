"""What the exact response of a structure says of its boundary under a ground motion, beside a traced one."""

from collections.abc import Sequence
from itertools import product

import numpy as np
import xarray as xr

from reliab.core.progress import Progress, silent
from reliab.motions.motion import Motion
from reliab.structures.structure import Structure
from reliab.sweep.labels import join_coordinates, motion_coordinates
from reliab.sweep.request import excitation_of
from reliab.sweep.results_accessor import ResultsAccessor, contours_of
from reliab.tracking.boundary.finite_errors import DIRECTIONS, predict_ellipse, scales_of_contour
from reliab.tracking.boundary.first_order import FirstOrderEllipse, first_order_ellipse
from reliab.tracking.indices.window import Window


def measure_responses(
    motions: Sequence[Motion],
    frequencies: Sequence[float],
    damping_ratios: Sequence[float],
    *,
    progress: Progress = silent,
) -> xr.Dataset:
    """Measure what the exact responses of structures say of the boundaries under ground motions.

    `motions`: the ground motions; read one at a time; `frequencies`, `damping_ratios`: the structures [Hz,
    -], wholly in the laboratory. Returns `a_first` [-] and `b_first` [ms²], the ellipse per squared RMS^R of
    the whole record in the limit of small errors, and `effective_duration` [s] = ∫x²dt/max x² of the
    response, over (motion, f, xi), with the coordinates of the motions.

    >>> from reliab.motions.loading import load_motions
    >>> measured = measure_responses(load_motions("synthetic")[:1], [1.0], [0.02, 0.05])
    >>> bool(measured["effective_duration"].max() < measured["duration"].max())
    True
    """
    rows, headers = [], []
    for count, motion in enumerate(motions, start=1):
        excitation = excitation_of(motion, Window())
        ellipses = [
            first_order_ellipse(excitation, Structure(frequency=f, damping_ratio=xi))
            for f, xi in product(frequencies, damping_ratios)
        ]
        rows.append([(ellipse.amplitude, ellipse.delay, ellipse.effective_duration) for ellipse in ellipses])
        headers.append(motion_coordinates([motion]))
        progress(count, len(motions))
    table = np.reshape(rows, (len(rows), len(frequencies), len(damping_ratios), 3))
    names = "a_first", "b_first", "effective_duration"
    return xr.Dataset(
        {name: (("motion", "f", "xi"), table[..., column]) for column, name in enumerate(names)},
        coords={**join_coordinates(headers), "f": list(frequencies), "xi": list(damping_ratios)},
    )


_DIMENSIONS = ("motion", "f", "xi", "threshold", "side")


def compare_boundaries(
    results: xr.Dataset,
    measures: xr.Dataset,
    thresholds: Sequence[float],
    *,
    progress: Progress = silent,
) -> xr.Dataset:
    """Compare the boundaries of stored results with those that the exact responses predict.

    `results`: errors RMS^R of whole records over the grid of actuators, wholly experimental; `measures`: what
    :func:`measure_responses` returned for the same motions and structures; `thresholds`: errors on the
    boundaries [-]. Returns `measures` with `scale` [-] over (motion, f, xi, threshold, side), the largest
    multiple of a and b of the predicted ellipse that lies wholly inside the boundary, and `scale_towards`
    [-], in addition over the `direction` [degrees] in the ellipse's own angle, the multiple that reaches the
    boundary there.
    """
    accessor = ResultsAccessor(results)
    pairs = [(threshold, side) for threshold in thresholds for side in accessor.sides]
    sizes = [results.sizes[name] for name in ("motion", "f", "xi")]
    scales = np.full((*sizes, len(pairs), 1 + DIRECTIONS.size), np.nan)
    places = list(product(range(sizes[1]), range(sizes[2])))
    for count, (row, column) in enumerate(places, start=1):
        structure_place = {"f": float(results["f"][row]), "xi": float(results["xi"][column])}
        structure, structure_measures = accessor.structure(**structure_place), measures.sel(structure_place)
        contours = contours_of(accessor.select_structure(**structure_place)["rms"], structure, pairs)
        for motion, motion_contours in enumerate(contours):
            response = _response(structure_measures.isel(motion=motion))
            scales[motion, row, column] = [
                scales_of_contour(contour, *predict_ellipse(response, structure, *pair))
                for contour, pair in zip(motion_contours, pairs, strict=True)
            ]
        progress(count, len(places))
    scales = scales.reshape(*sizes, len(thresholds), len(accessor.sides), -1)
    return measures.assign(
        {
            "scale": (_DIMENSIONS, scales[..., 0]),
            "scale_towards": ((*_DIMENSIONS, "direction"), scales[..., 1:]),
        }
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
