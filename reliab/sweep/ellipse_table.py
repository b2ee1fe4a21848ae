"""Ellipses of many ground motions, traced straight from the loop without a stored grid."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.boundary import Curve, Ellipse, motion_contours
from reliab.indices.window import Window
from reliab.loop.engine import Engine
from reliab.loop.excitation import Excitation
from reliab.loop.hybrid_test import HybridTest
from reliab.loop.structure import Structure
from reliab.motions import Motion
from reliab.progress import Progress, silent
from reliab.sweep.labels import with_labels
from reliab.sweep.records import motion_coordinates
from reliab.sweep.request import check_model, loop_of
from reliab.vocabulary import ELLIPSE_DIMENSIONS, Dimension, Metric

_COLUMNS = ("a", "b", "sse", "n")


@dataclass(frozen=True, kw_only=True)
class EllipseRequest:
    """For which structures, errors and curves boundaries are wanted.

    Parameters
    ----------
    frequencies : tuple of float
        Natural frequencies [Hz].
    damping_ratios : tuple of float
        Damping ratios [-].
    thresholds : tuple of float, optional
        Errors on the boundary [-].
    metrics : tuple of Metric, optional
        Which errors.
    curves : tuple of type, optional
        Curves fitted to the boundary.
    window : Window, optional
        Stretch of the record over which the error is taken.
    experimental_fraction : float, optional
        Share of the stiffness in the laboratory [-].
    engine : Engine, optional
        How the loop is solved.
    model : HybridTest, optional
        A model with effects of the one structure that is asked for; the boundary is then one of gain
        and delay of the actuator alone.

    Raises
    ------
    InputError
        If the model is of another structure.
    """

    frequencies: tuple[float, ...]
    damping_ratios: tuple[float, ...]
    thresholds: tuple[float, ...] = (0.05,)
    metrics: tuple[Metric, ...] = (Metric.RMS,)
    curves: tuple[type[Curve], ...] = (Ellipse,)
    window: Window = field(default_factory=Window)
    experimental_fraction: float = 1.0
    engine: Engine = Engine.AUTOMATIC
    model: HybridTest | None = None

    def __post_init__(self) -> None:
        check_model(self.model, self.structures)

    @property
    def structures(self) -> list[Structure]:
        """Every structure, the damping ratio varying fastest."""
        return [
            Structure(frequency=f, damping_ratio=xi, experimental_fraction=self.experimental_fraction)
            for f in self.frequencies
            for xi in self.damping_ratios
        ]


def trace_ellipses(
    motions: Sequence[Motion], request: EllipseRequest, *, progress: Progress = silent
) -> xr.Dataset:
    """Trace the boundaries of many ground motions and fit curves to them.

    Parameters
    ----------
    motions : sequence of Motion
        The ground motions; read one at a time.
    request : EllipseRequest
        Structures, thresholds, metrics and curves.
    progress : callable, optional
        Called after each motion.

    Returns
    -------
    xarray.Dataset
        `a` [-], `b` [ms²], `sse` [ms⁴] and `n` over (motion, f, xi, threshold, metric, curve); zero
        where the model's effects alone exceed the threshold.
    """
    tables, headers = [], []
    for done, motion in enumerate(motions, start=1):
        tables.append(motion_table(motion, request))
        headers.append(motion_coordinates([motion]))
        progress(done, len(motions))
    return ellipse_dataset(np.stack(tables), headers, request)


def motion_table(motion: Motion, request: EllipseRequest) -> NDArray[np.float64]:
    """Curve parameters of one motion, shape (f, xi, threshold, metric, curve, 4)."""
    bounds = request.window.bounds(motion.acceleration, motion.time_step)
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step, window=bounds)
    rows = []
    for structure in request.structures:
        loop = loop_of(request.model, excitation, structure, request.engine)
        for metric in request.metrics:
            for contour in motion_contours(loop, request.thresholds, metric):
                fits = (curve.fit(contour) for curve in request.curves)
                rows.append([[getattr(fit, column) for column in _COLUMNS] for fit in fits])
    shape = (
        len(request.frequencies),
        len(request.damping_ratios),
        len(request.metrics),
        len(request.thresholds),
        len(request.curves),
        len(_COLUMNS),
    )
    return np.array(rows, dtype=np.float64).reshape(shape).swapaxes(2, 3)


def ellipse_dataset(
    table: NDArray[np.float64], headers: Sequence[dict[str, xr.Variable]], request: EllipseRequest
) -> xr.Dataset:
    """Label a table of curve parameters, shape (motion, f, xi, threshold, metric, curve, 4)."""
    coordinates = {
        name: (Dimension.MOTION, np.concatenate([header[name].values for header in headers]))
        for name in headers[0]
    }
    dataset = xr.Dataset(
        {column: (ELLIPSE_DIMENSIONS, table[..., k]) for k, column in enumerate(_COLUMNS)},
        coords={
            **coordinates,
            "f": list(request.frequencies),
            "xi": list(request.damping_ratios),
            "threshold": list(request.thresholds),
            "metric": [str(metric) for metric in request.metrics],
            "curve": [curve.name for curve in request.curves],
        },
    )
    dataset.attrs["window"] = request.window.label
    dataset.attrs["experimental_fraction"] = request.experimental_fraction
    return with_labels(dataset)
