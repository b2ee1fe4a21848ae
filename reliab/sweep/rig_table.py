"""What ground motions do to the actuators of a frame: the error of its described rig, allowed coupling."""

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import scipy

from reliab.arrays import Array
from reliab.errors import InputError
from reliab.indices import Window, relative_error
from reliab.indices.frequency_evaluation import frequency_evaluation
from reliab.indices.response_error import response_error
from reliab.motions import Motion
from reliab.progress import Progress, silent
from reliab.simulation import Excitation
from reliab.simulation.frames import (
    FrameLoop,
    FrameUnderTest,
    stable_with,
)
from reliab.sweep.request import excitation_of
from reliab.vocabulary import MILLI, Metric

if TYPE_CHECKING:
    from reliab.simulation.transfer_systems import ActuatorMatrix, TransferSystem

LARGEST_COUPLING = 0.9
"""Share [-] of another actuator's command up to which limits are looked for."""

LARGEST_ERROR = 10.0
"""Error [-] that stands for any larger one."""


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
    def beyond(share: float) -> float:
        cells = loop.cells(gain=1.0 + side * share, delay=0.0)
        return min(float(relative_error(loop.deviation(cells), metric)[0]), LARGEST_ERROR) - threshold

    if beyond(LARGEST_COUPLING) < 0.0:
        return LARGEST_COUPLING
    return float(scipy.optimize.brentq(beyond, 0.0, LARGEST_COUPLING, rtol=1e-3))


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
        rows.append((motion.name, *_tried(frame, excitation_of(motion, window))))
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


def _tried(frame: FrameUnderTest, excitation: Excitation) -> tuple[float, float, float, float]:
    """RMS^R, MTE^R and A [-], d [ms] of the rig under one motion."""
    loop = FrameLoop(excitation=excitation, partition=frame.partition, output=frame.output)
    test = loop.response(_rig(frame))
    judged = np.flatnonzero(loop.judged)
    rms, mte = (
        np.array([response_error(test.response[place], test.ideal[place], metric) for place in judged])
        for metric in (Metric.RMS, Metric.MTE)
    )
    worst = judged[np.argmax(rms)]
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
