"""Contours of equal error traced on the grid of a results dataset."""

from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.boundary import REACH, Contour, ErrorSurfaces, furthest_lead, trace_contours
from reliab.structures import Structure
from reliab.vocabulary import Metric, Side

_TOGETHER = 32  # motions


def batches(motions: int) -> Iterator[slice]:
    """Divide motions into some at a time, so that memory does not grow with their number.

    >>> [(some.start, some.stop) for some in batches(70)]
    [(0, 32), (32, 64), (64, 70)]
    """
    for begin in range(0, motions, _TOGETHER):
        yield slice(begin, min(begin + _TOGETHER, motions))


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


def errors_at_rest(results: xr.Dataset, metrics: Sequence[Metric]) -> NDArray[np.float64] | None:
    """Error of an actuator that does not move.

    Returns [-].
    Returns error [-], shape (motion, f, xi, metric); None where the results are of an older version.
    """
    if "rms_at_rest" not in results:
        return None
    rms = results["rms_at_rest"].transpose("motion", "f", "xi").values.astype(np.float64)
    # Without motion the deviation is the exact response, whose peak normalises MTE^R, so that MTE^R is 1.
    by_metric = {Metric.RMS: rms, Metric.MTE: np.ones_like(rms)}
    return np.stack([by_metric[metric] for metric in metrics], axis=-1)
