"""The error of a test and where it comes from, for its report."""

import numpy as np
import pandas as pd

from reliab.report.document import Column, Figure, Table
from reliab.report.figures.measured_test import error_over_time
from reliab.report.kinds.wording import PERCENT
from reliab.validation.assessment.assessment import Assessment
from reliab.vocabulary import Metric

_STRETCHES = 40


def errors_table(found: Assessment) -> Table:
    """Tabulate the error with its interval, and its parts.

    Parameters
    ----------
    found : Assessment
        The assessed test.

    Returns
    -------
    Table
        RMS^R and MTE^R, and RMS^R of each part.
    """
    rows = []
    for name, metric in (("RMSᴿ", Metric.RMS), ("MTEᴿ", Metric.MTE)):
        size = found.error.of(metric)
        rows.append(
            (
                name,
                f"{PERCENT * size.value:.2f}",
                f"{PERCENT * size.low:.2f} to {PERCENT * size.high:.2f}",
                "",
            )
        )
    for name, part in found.error.parts.by_name.items():
        rows.append(
            (
                f"RMSᴿ from {name.replace('_', ' ')} alone",
                f"{PERCENT * part.rms:.2f}",
                "",
                f"{PERCENT * part.remaining_rms:.2f}",
            )
        )
    frame = pd.DataFrame(rows, columns=["quantity", "value", "interval", "remaining"])
    headings = ("Error, over the peak of the exact displacement", "Found [%]", "90 % interval", "Without it")
    return Table(
        frame=frame,
        columns=tuple(
            Column(key=key, heading=heading, wide=key == "quantity")
            for key, heading in zip(frame.columns, headings, strict=True)
        ),
        caption=(
            f"Error over the test's own {found.recording.duration:.4g} s: root mean square and largest value "
            "of measured minus exact displacement. The last column is what would remain without the part."
        ),
        label="tab:errors",
    )


def histories_figure(found: Assessment) -> Figure:
    """Draw exact and measured history, the error with its band, and its parts.

    Parameters
    ----------
    found : Assessment
        The assessed test.

    Returns
    -------
    Figure
        Three panels over time.
    """
    rebuilt, recording = found.error.rebuilt, found.recording
    stretch = recording.duration / _STRETCHES
    return Figure(
        drawing=error_over_time(
            times=np.linspace(0.0, recording.duration, recording.command.size),
            reference=rebuilt.reference,
            measured=rebuilt.reference + rebuilt.smooth_error,
            error=rebuilt.smooth_error,
            band=(rebuilt.low, rebuilt.high),
            parts={
                name.replace("_", " "): sizes
                for name, sizes in found.error.parts.over_time(recording.time_step, stretch).items()
            },
        ),
        caption="Exact and measured response, the error with its 90 % band, and where it comes from.",
        label="fig:error",
    )
