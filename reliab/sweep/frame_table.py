"""A partitioned frame under many ground motions: its ellipses, and the error of its described rig."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pandas as pd
import xarray as xr

from reliab.arrays import Array
from reliab.boundary import Curve, motion_contours
from reliab.errors import InputError
from reliab.indices import Window, relative_error
from reliab.indices.frequency_evaluation import frequency_evaluation
from reliab.indices.response_error import response_error
from reliab.motions import Motion
from reliab.progress import Progress, silent
from reliab.simulation.frames import FrameLoop, FrameUnderTest, rig_response, stable_with
from reliab.structures import Structure
from reliab.structures.critical_delay import critical_delay
from reliab.sweep.ellipse_dataset import COLUMNS, CURVES, curve_table, ellipse_dataset
from reliab.sweep.labels import join_coordinates, motion_coordinates
from reliab.sweep.request import excitation_of
from reliab.vocabulary import MILLI, Metric, Side

if TYPE_CHECKING:
    from reliab.boundary import SolvedLoop


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameRequest:
    """Errors and curves for which boundaries of a frame are traced.

    Raises InputError if no delay, however short, leaves the test stable.
    """

    # The partitioned frame, with a linear specimen, and the response whose error counts
    frame: FrameUnderTest
    thresholds: tuple[float, ...] = (0.05,)  # Errors on the boundary [-]
    metrics: tuple[Metric, ...] = (Metric.RMS,)  # RMS^R, MTE^R or both
    curves: tuple[type[Curve], ...] = CURVES  # Curves fitted to the boundary
    sides: tuple[Side, ...] = tuple(Side)  # Sides of the boundary: actuators that are late, early, or both
    window: Window = field(default_factory=Window)  # Part of the record over which the error is computed

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

    `motions`: the ground motions; read one at a time.
    `request`: frame, thresholds, metrics, curves and sides.
    Returns what `trace_ellipses` does, with one f [Hz] and one xi [-], those of the mode that governs
    the error. The attribute `experimental_fraction` is the specimen's share in that mode, `frame` the frame's
    name and `error_of` the response whose error counts.
    """
    mode = governing_mode(request.frame)
    tables, errors_at_rest, headers = [], [], []
    for done, motion in enumerate(motions, start=1):
        loop = FrameLoop(
            excitation=excitation_of(motion, request.window),
            partition=request.frame.partition,
            output=request.frame.output,
        )
        errors_at_rest.append([[[relative_error(loop.at_rest(), metric)[0] for metric in request.metrics]]])
        tables.append(_table(loop, request))
        headers.append(motion_coordinates([motion]))
        progress(done, len(motions))
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
            "frame": request.frame.name,
            "error_of": request.frame.error_of,
        },
        error_at_rest=np.array(errors_at_rest),
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


def _table(loop: FrameLoop, request: FrameRequest) -> Array:
    """Curves of one motion, shape (threshold, metric, curve, side, columns)."""
    pairs = [(threshold, side) for threshold in request.thresholds for side in request.sides]
    levels, sides = zip(*pairs, strict=True)
    contours = [
        motion_contours(cast("SolvedLoop", loop), levels, metric, side=sides) for metric in request.metrics
    ]
    sizes = len(request.thresholds), len(request.sides), len(request.curves), len(COLUMNS)
    table = curve_table(contours, request.curves).reshape(len(request.metrics), *sizes)
    return table.transpose(1, 0, 3, 2, 4)


def errors_of_rig(
    frame: FrameUnderTest, motions: Sequence[Motion], *, window: Window, progress: Progress = silent
) -> pd.DataFrame:
    """Compute the error of the rig that a frame's description states.

    `frame`: the frame with its transfer system and a linear specimen.
    `motions`: the ground motions; read one at a time.
    `window`: part of the record over which the error is computed.
    Returns one row for each motion: `motion`, `rms` and `mte` [-], `A` [-] and `d_ms` of the interface. Empty
    where the test is unstable with this rig.
    Raises InputError if no transfer system is described, or the specimen is nonlinear.
    """
    if frame.transfer_system is None:
        raise InputError(
            "The error of a rig needs its transfer system",
            value="no [transfer_system]",
            remedy="Describe it in the file of the frame",
        )
    if frame.partition.effects:
        raise InputError(
            "The error of a described rig is computed for a linear specimen",
            value=", ".join(effect.name for effect in frame.partition.effects),
            remedy="Leave [[specimen.effects]] out",
        )
    columns = ["motion", "rms", "mte", "A", "d_ms"]
    if not stable_with(frame.partition, frame.transfer_system):
        return pd.DataFrame(columns=columns)
    rows = []
    for done, motion in enumerate(motions, start=1):
        test = rig_response(
            excitation_of(motion, window), frame.partition, frame.transfer_system, frame.output
        )
        index = frequency_evaluation(test.command, test.measured, test.step)
        errors = [response_error(test.response, test.ideal, metric) for metric in (Metric.RMS, Metric.MTE)]
        rows.append((motion.name, *errors, index.amplitude, MILLI * index.equivalent_delay))
        progress(done, len(motions))
    return pd.DataFrame(rows, columns=columns)


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
