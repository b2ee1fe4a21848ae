"""Ellipses of a partitioned frame under many ground motions: a criterion for one laboratory's structure."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.boundary import motion_contours
from reliab.boundary.curves import Curve
from reliab.errors import InputError
from reliab.indices import Window, relative_error
from reliab.motions import Motion
from reliab.progress import Progress, silent
from reliab.simulation.frames import FrameLoop, FrameUnderTest
from reliab.structures import Structure
from reliab.structures.critical_delay import critical_delay
from reliab.sweep.ellipse_dataset import COLUMNS, CURVES, curve_table, ellipse_dataset
from reliab.sweep.excitation import excitation_of
from reliab.sweep.records import joined_coordinates, motion_coordinates
from reliab.vocabulary import Metric, Side

if TYPE_CHECKING:
    from reliab.boundary import SolvedLoop


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameRequest:
    """Errors and curves for which boundaries of a frame are traced.

    Parameters
    ----------
    frame : FrameUnderTest
        The partitioned frame, with a linear specimen, and the response whose error counts.
    thresholds : tuple of float, optional
        Errors on the boundary [-].
    metrics : tuple of Metric, optional
        RMS^R, MTE^R or both.
    curves : tuple of type, optional
        Curves fitted to the boundary.
    sides : tuple of Side, optional
        Sides of the boundary: actuators that are late, early, or both.
    window : Window, optional
        Part of the record over which the error is computed.

    Raises
    ------
    InputError
        If no delay, however short, leaves the test stable.
    """

    frame: FrameUnderTest
    thresholds: tuple[float, ...] = (0.05,)
    metrics: tuple[Metric, ...] = (Metric.RMS,)
    curves: tuple[type[Curve], ...] = CURVES
    sides: tuple[Side, ...] = tuple(Side)
    window: Window = field(default_factory=Window)

    def __post_init__(self) -> None:
        delay, _ = critical_delay(self.frame.partition)
        if delay == 0.0:
            raise InputError(
                "A boundary needs a test that tolerates some delay",
                value="a specimen with half of the mass at its interface or more",
                remedy="Leave more of the mass to the computer",
            )


def trace_frame_ellipses(
    motions: Sequence[Motion], request: FrameRequest, *, progress: Progress = silent
) -> xr.Dataset:
    """Trace the boundaries of a frame under many ground motions and fit curves to them.

    Parameters
    ----------
    motions : sequence of Motion
        The ground motions; read one at a time.
    request : FrameRequest
        Frame, thresholds, metrics, curves and sides.
    progress : callable, optional
        Called after each motion.

    Returns
    -------
    xarray.Dataset
        As returned by `trace_ellipses`, with one f [Hz] and one xi [-], those of the mode that governs the
        error. The attribute `experimental_fraction` is the specimen's share in that mode, `frame` the
        frame's name and `error_of` the response whose error counts.
    """
    mode = governing_mode(request.frame)
    tables, rests, headers = [], [], []
    for done, motion in enumerate(motions, start=1):
        loop = FrameLoop(
            excitation=excitation_of(motion, request.window),
            partition=request.frame.partition,
            output=request.frame.output,
        )
        rests.append([[[relative_error(loop.at_rest(), metric)[0] for metric in request.metrics]]])
        tables.append(_table(loop, request))
        headers.append(motion_coordinates([motion]))
        progress(done, len(motions))
    return ellipse_dataset(
        np.stack(tables)[:, np.newaxis, np.newaxis],
        {**joined_coordinates(headers), "f": [mode.frequency], "xi": [mode.damping_ratio]},
        thresholds=request.thresholds,
        metrics=request.metrics,
        curves=request.curves,
        sides=request.sides,
        attributes={
            "window": request.window.label,
            "experimental_fraction": mode.experimental_fraction,
            "frame": request.frame.name,
            "error_of": request.frame.error_of,
        },
        error_at_rest=np.array(rests),
    )


def governing_mode(frame: FrameUnderTest) -> Structure:
    """Frequency, damping ratio and share of the specimen of the mode that governs the error of a frame."""
    place = FrameLoop.governing(frame.partition, frame.output)
    share = abs(float(frame.partition.impedance_shares[place].real))
    return Structure(
        frequency=float(frame.partition.frame.modes.frequency[place]),
        damping_ratio=float(frame.partition.frame.damping_ratios[place]),
        experimental_fraction=float(np.clip(share, 1e-6, 1.0)),
    )


def _table(loop: FrameLoop, request: FrameRequest) -> NDArray[np.float64]:
    """Curves of one motion, shape (threshold, metric, curve, side, columns)."""
    pairs = [(threshold, side) for threshold in request.thresholds for side in request.sides]
    levels, sides = zip(*pairs, strict=True)
    contours = [
        motion_contours(cast("SolvedLoop", loop), levels, metric, side=sides) for metric in request.metrics
    ]
    sizes = len(request.thresholds), len(request.sides), len(request.curves), len(COLUMNS)
    table = curve_table(contours, request.curves).reshape(len(request.metrics), *sizes)
    return table.transpose(1, 0, 3, 2, 4)
