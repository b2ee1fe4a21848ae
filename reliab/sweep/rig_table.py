"""The error that a described rig has in tests of a frame under many ground motions."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from reliab.errors import InputError
from reliab.indices import Window
from reliab.indices.frequency_evaluation import frequency_evaluation
from reliab.indices.response_error import response_error
from reliab.motions import Motion
from reliab.progress import Progress, silent
from reliab.simulation.frames import FrameUnderTest, rig_response, stable_with
from reliab.sweep.excitation import excitation_of
from reliab.vocabulary import MILLI, Metric


def errors_of_rig(
    frame: FrameUnderTest, motions: Sequence[Motion], *, window: Window, progress: Progress = silent
) -> pd.DataFrame:
    """Compute the error of the rig that a frame's description states.

    Parameters
    ----------
    frame : FrameUnderTest
        The frame with its transfer system and a linear specimen.
    motions : sequence of Motion
        The ground motions; read one at a time.
    window : Window
        Part of the record over which the error is computed.
    progress : callable, optional
        Called after each motion.

    Returns
    -------
    pandas.DataFrame
        One row for each motion: `motion`, `rms` and `mte` [-], `A` [-] and `d_ms` of the interface. Empty
        where the test is unstable with this rig.

    Raises
    ------
    InputError
        If no transfer system is described, or the specimen is nonlinear.
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


def summary_of_rig(errors: pd.DataFrame, metric: str, threshold: float) -> dict[str, object]:
    """Summarise the errors of a rig: how many motions it serves, and the error of most of them.

    Parameters
    ----------
    errors : pandas.DataFrame
        As `errors_of_rig` returns them.
    metric : str
        "rms" or "mte".
    threshold : float
        Largest error of a reliable test [-].

    Returns
    -------
    dict
        `stable`, `metric`, `threshold`, `share_below`, `median`, `largest` [-] and one entry of `motions` for
        each; shares and errors are None where the test is unstable.
    """
    sizes = errors[metric].to_numpy(dtype=float)
    known = bool(sizes.size)
    return {
        "stable": known,
        "metric": metric,
        "threshold": threshold,
        "share_below": float(np.mean(sizes < threshold)) if known else None,
        "median": float(np.median(sizes)) if known else None,
        "largest": float(sizes.max()) if known else None,
        "motions": errors.to_dict("records"),
    }
