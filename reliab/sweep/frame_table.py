"""Ellipses of a structure with one actuator or several under many ground motions."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

import numpy as np
import xarray as xr

from reliab.arrays import Array
from reliab.boundary import AMPLITUDE_STEP, Curve, motion_contours
from reliab.errors import InputError
from reliab.indices import Window, relative_error
from reliab.motions import Motion
from reliab.progress import Progress, silent
from reliab.simulation.frames import FrameLoop, FrameUnderTest
from reliab.structures import stability_limit
from reliab.sweep.ellipse_dataset import COLUMNS, CURVES, curve_table, ellipse_dataset
from reliab.sweep.labels import join_coordinates, motion_coordinates
from reliab.sweep.request import excitation_of
from reliab.vocabulary import Metric, Side

if TYPE_CHECKING:
    from reliab.boundary import SolvedLoop


_WORST = "the interface displacement whose error is largest"
_FEW_AMPLITUDES = 0.01
"""Step of the amplitude [-] with several actuators, whose cells are dearer: some eleven to thirty points."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameRequest:
    """Errors and curves for which boundaries of a frame are traced.

    Raises InputError if no delay, however short, leaves the test stable, or there is no such actuator.
    """

    # The partitioned frame, with a linear specimen, and the response whose error counts
    frame: FrameUnderTest
    actuator: int | None = None  # Number of the one that errs, from 1; None where all err alike
    thresholds: tuple[float, ...] = (0.05,)  # Errors on the boundary [-]
    metrics: tuple[Metric, ...] = (Metric.RMS,)  # RMS^R, MTE^R or both
    curves: tuple[type[Curve], ...] = CURVES  # Curves fitted to the boundary
    sides: tuple[Side, ...] = tuple(Side)  # Sides of the boundary: actuators that are late, early, or both
    window: Window = field(default_factory=Window)  # Part of the record over which the error is computed

    def __post_init__(self) -> None:
        actuators = self.frame.partition.degrees
        if self.actuator is not None and not 1 <= self.actuator <= actuators:
            raise InputError(
                f"The actuator that errs is one of the structure's {actuators}",
                value=self.actuator,
                remedy="Count them from 1, as the rows of [kinematics]",
            )
        if stability_limit(self.frame.partition).delay == 0.0:
            raise InputError(
                "A boundary needs a test that tolerates some delay",
                value="a specimen with half of the mass at its interface or more",
                remedy="Leave more of the mass to the computer",
            )


def trace_frame_ellipses(
    motions: Sequence[Motion], request: FrameRequest, *, progress: Progress = silent
) -> xr.Dataset:
    """Trace the boundaries of a frame under many ground motions and fit curves to them.

    `motions`: the ground motions; read one at a time.
    `request`: frame, thresholds, metrics, curves and sides.
    Returns what `trace_ellipses` does, with one f [Hz] and one xi [-], those of the mode that governs
    the error. The attribute `experimental_fraction` is the specimen's share in that mode, `frame` the frame's
    name and `error_of` the response whose error counts.
    """
    tables, errors_at_rest, headers, modes = [], [], [], []
    frame = request.frame
    for motion in motions:
        loop = FrameLoop(
            excitation=excitation_of(motion, request.window),
            partition=frame.partition,
            kinematics=frame.kinematics,
            actuator=None if request.actuator is None else request.actuator - 1,
            output=frame.output,
        )
        modes.append(loop.governing_mode)
        errors_at_rest.append([[[relative_error(loop.at_rest(), metric)[0] for metric in request.metrics]]])
        tables.append(_table(loop, request))
        headers.append(motion_coordinates([motion]))
        progress(len(headers), len(motions))
    mode = modes[0]
    return ellipse_dataset(
        np.stack(tables)[:, np.newaxis, np.newaxis],
        {**join_coordinates(headers), "f": [mode.frequency], "xi": [mode.damping_ratio]},
        thresholds=request.thresholds,
        metrics=request.metrics,
        curves=request.curves,
        sides=request.sides,
        attributes={
            "window": request.window.label,
            "experimental_fraction": mode.experimental_fraction,
            "frame": frame.name,
            "error_of": _WORST if frame.several else frame.error_of,
            "erring_actuator": "all alike" if request.actuator is None else request.actuator,
        },
        error_at_rest=np.array(errors_at_rest),
    )


def _table(loop: FrameLoop, request: FrameRequest) -> Array:
    """Curves of one motion, shape (threshold, metric, curve, side, columns)."""
    step = _FEW_AMPLITUDES if request.frame.several else AMPLITUDE_STEP
    pairs = [(threshold, side) for threshold in request.thresholds for side in request.sides]
    levels, sides = zip(*pairs, strict=True)
    contours = [
        motion_contours(cast("SolvedLoop", loop), levels, metric, side=sides, amplitude_step=step)
        for metric in request.metrics
    ]
    sizes = len(request.thresholds), len(request.sides), len(request.curves), len(COLUMNS)
    table = curve_table(contours, request.curves).reshape(len(request.metrics), *sizes)
    return table.transpose(1, 0, 3, 2, 4)
