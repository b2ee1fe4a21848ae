"""What ground motions do to the actuators of a frame: ellipses, the error of its rig, allowed coupling."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pandas as pd
import scipy
import xarray as xr

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.vocabulary import MILLI, Metric, Side
from reliab.motions.motion import Motion
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.simulation.frames.frame_loop import FrameLoop, stable_with
from reliab.structures.critical_delay import stability_limit
from reliab.sweep.ellipse_dataset import COLUMNS, CURVES, curve_table, ellipse_dataset
from reliab.sweep.labels import join_coordinates, motion_coordinates
from reliab.sweep.request import excitation_of
from reliab.tracking.boundary.contour import AMPLITUDE_STEP
from reliab.tracking.boundary.curves import Curve
from reliab.tracking.boundary.suite_boundary import motion_contours
from reliab.tracking.indices.response_error import relative_error, response_error
from reliab.tracking.indices.tracking import frequency_evaluation
from reliab.tracking.indices.window import Window

if TYPE_CHECKING:
    from reliab.simulation.transfer_systems.transfer_function import ActuatorMatrix, TransferSystem
    from reliab.tracking.boundary.suite_boundary import SolvedLoop

_WORST = "the interface displacement whose error is largest"
_FEW_AMPLITUDES = 0.01
"""Step of the amplitude [-] with several actuators, whose cells are dearer: some eleven to thirty points."""

LARGEST_COUPLING = 0.9
"""Share [-] of another actuator's command up to which limits are looked for."""

LARGEST_ERROR = 10.0
"""Error [-] that stands for any larger one."""


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
                f"No such actuator; the structure has {actuators}",
                value=self.actuator,
                remedy="Count them from 1, as the rows of [kinematics]",
            )
        if stability_limit(self.frame.partition).delay == 0.0:
            raise InputError(
                "This loop is unstable without any delay, so it has no boundary",
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
        errors_at_rest.append(
            [[[relative_error(loop.rest_deviation(), metric)[0] for metric in request.metrics]]]
        )
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
            "error_of": _WORST if frame.has_several else frame.error_of,
            "erring_actuator": "all alike" if request.actuator is None else request.actuator,
        },
        error_at_rest=np.array(errors_at_rest),
    )


def _table(loop: FrameLoop, request: FrameRequest) -> Array:
    """Curves of one motion, shape (threshold, metric, curve, side, columns)."""
    step = _FEW_AMPLITUDES if request.frame.has_several else AMPLITUDE_STEP
    pairs = [(threshold, side) for threshold in request.thresholds for side in request.sides]
    levels, sides = zip(*pairs, strict=True)
    contours = [
        motion_contours(cast("SolvedLoop", loop), levels, metric, side=sides, amplitude_step=step)
        for metric in request.metrics
    ]
    sizes = len(request.thresholds), len(request.sides), len(request.curves), len(COLUMNS)
    table = curve_table(contours, request.curves).reshape(len(request.metrics), *sizes)
    return table.transpose(1, 0, 3, 2, 4)


def limits_of_coupling(
    frame: FrameUnderTest,
    motions: Sequence[Motion],
    *,
    threshold: float,
    metric: Metric,
    window: Window,
    progress: Progress = silent,
) -> Array:
    """How far each actuator may move with the command of each other one, under each motion.

    `threshold`: error on the limit [-].
    Returns shares of that command [-], the smaller of both signs, shape (motions, p, p): of the actuator by
    rows, of the command by columns, zero on the diagonal; `LARGEST_COUPLING` where no smaller share reaches
    the threshold.
    """
    size = frame.partition.degrees
    limits = np.zeros((len(motions), size, size))
    for place, motion in enumerate(motions):
        excitation = excitation_of(motion, window)
        for pair in itertools.permutations(range(size), 2):
            loop = FrameLoop(
                excitation=excitation, partition=frame.partition, kinematics=frame.kinematics, actuator=pair
            )
            limits[place][pair] = min(_limit_of_coupling(loop, threshold, metric, side) for side in (-1, 1))
        progress(place + 1, len(motions))
    return limits


def _limit_of_coupling(loop: FrameLoop, threshold: float, metric: Metric, side: int) -> float:
    def excess(share: float) -> float:
        cells = loop.cells(gain=1.0 + side * share, delay=0.0)
        return min(float(relative_error(loop.deviation(cells), metric)[0]), LARGEST_ERROR) - threshold

    if excess(LARGEST_COUPLING) < 0.0:
        return LARGEST_COUPLING
    return float(scipy.optimize.brentq(excess, 0.0, LARGEST_COUPLING, rtol=1e-3))


def errors_of_rig(
    frame: FrameUnderTest,
    motions: Sequence[Motion],
    *,
    window: Window,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Compute the error of the rig that a frame's description states.

    `frame`: the structure with its transfer system and a linear specimen. With several actuators errors are
    those of the interface displacement whose error is largest, and so are A and d.
    `motions`: the ground motions; read one at a time.
    `window`: part of the record over which the error is computed.
    Returns one row for each motion: `motion`, `rms` and `mte` [-], `A` [-] and `d_ms` of the interface. Empty
    where the test is unstable with this rig.
    Raises InputError if no transfer system is described, or the specimen is nonlinear.
    """
    rig = _rig(frame)
    if frame.partition.effects:
        raise InputError(
            "The error of a described rig is computed for a linear specimen",
            value=", ".join(effect.name for effect in frame.partition.effects),
            remedy="Leave [[specimen.effects]] out",
        )
    columns = ["motion", "rms", "mte", "A", "d_ms"]
    if not stable_with(frame.partition, rig):
        return pd.DataFrame(columns=columns)
    rows = []
    for motion in motions:
        rows.append((motion.name, *_simulate_rig(frame, excitation_of(motion, window))))
        progress(len(rows), len(motions))
    return pd.DataFrame(rows, columns=columns)


def _rig(frame: FrameUnderTest) -> "TransferSystem | ActuatorMatrix":
    if frame.transfer_system is None:
        raise InputError(
            "The error of a rig needs its transfer system",
            value="no [transfer_system]",
            remedy="Describe it in the file of the frame",
        )
    return frame.transfer_system


def _simulate_rig(frame: FrameUnderTest, excitation: Excitation) -> tuple[float, float, float, float]:
    """RMS^R, MTE^R and A [-], d [ms] of the rig under one motion."""
    loop = FrameLoop(excitation=excitation, partition=frame.partition, output=frame.output)
    test = loop.response(_rig(frame))
    outputs = np.flatnonzero(loop.is_output)
    rms, mte = (
        np.array([response_error(test.response[place], test.ideal[place], metric) for place in outputs])
        for metric in (Metric.RMS, Metric.MTE)
    )
    worst = outputs[np.argmax(rms)]
    index = frequency_evaluation(test.command[worst], test.measured[worst], test.step)
    return float(rms.max()), float(mte.max()), index.amplitude, MILLI * index.equivalent_delay


def summary_of_rig(errors: pd.DataFrame, metric: str, threshold: float) -> dict[str, Any]:
    """Summarise the errors of a rig: how many motions it serves, and the error of most of them.

    `threshold`: largest error of a reliable test [-]. Returns `stable`, `metric`, `threshold`, `share_below`,
    `median`, `largest` [-] and one entry of `motions` for each; shares and errors are None where the test is
    unstable.
    """
    sizes = errors[metric].to_numpy(dtype=float)
    stable = bool(sizes.size)
    return {
        "stable": stable,
        "metric": metric,
        "threshold": threshold,
        "share_below": float(np.mean(sizes < threshold)) if stable else None,
        "median": float(np.median(sizes)) if stable else None,
        "largest": float(sizes.max()) if stable else None,
        "motions": errors.to_dict("records"),
    }
