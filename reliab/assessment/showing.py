"""Display of the verdict on a test: a table for notebooks, and a plot of the error."""

from typing import TYPE_CHECKING

import numpy as np

from reliab.html_table import html_table
from reliab.significant import percent_with_interval, significant
from reliab.vocabulary import MILLI

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from reliab.assessment.findings import Findings


def table_of_assessment(assessment: "Findings") -> str:
    """Write verdict, error, A, d and index of a test as a table in HTML."""
    error, placed = assessment.error, assessment.population
    rms, mte = error.rebuilt.rms, error.rebuilt.mte
    rows = {
        "verdict": str(assessment.verdict.word).replace("_", " "),
        f"probability of an error below {significant(error.threshold)} {error.metric.upper()}": _probability(
            error.probability
        ),
        "RMS error": percent_with_interval(rms.value, rms.low, rms.high),
        "largest error": percent_with_interval(mte.value, mte.low, mte.high),
        "amplitude A": f"{assessment.tracking.amplitude:.4f}",
        "equivalent delay d": f"{MILLI * assessment.tracking.delay:.3f} ms",
        "index by the criterion": "none" if placed.index is None else significant(placed.index),
    }
    return html_table(assessment.recording.name, rows, assessment.verdict.reasons)


def _probability(probability: float) -> str:
    if probability > 0.99:  # noqa: PLR2004 - no more is claimed
        return "> 0.99"
    return f"{max(probability, 0.01):.2f}" if probability >= 0.01 else "< 0.01"  # noqa: PLR2004


def draw_error(assessment: "Findings", axes: "Axes | None" = None) -> "Axes":
    """Draw the rebuilt error of a test over time.

    Returns with time [s] across and x_m − x_I [mm] upwards, its 90 % band, and the threshold times the peak
    of the exact response.
    """
    from matplotlib import pyplot as plt

    shown = plt.subplots(figsize=(8.0, 3.0))[1] if axes is None else axes
    rebuilt = assessment.error.rebuilt
    time = np.arange(rebuilt.error.size) * rebuilt.time_step
    bound = MILLI * assessment.error.threshold * float(np.abs(rebuilt.reference).max())
    shown.fill_between(time, MILLI * rebuilt.low, MILLI * rebuilt.high, alpha=0.3, label="90 % band")
    shown.plot(time, MILLI * rebuilt.smooth_error, linewidth=0.8, label="rebuilt error")
    for sign in (-1.0, 1.0):
        shown.axhline(sign * bound, color="0.3", linewidth=0.8, linestyle="--")
    shown.set(xlabel="time [s]", ylabel="x_m − x_I [mm]", title=assessment.recording.name)
    shown.legend(frameon=False)
    return shown
