"""What is found about a test, in numbers and in words, as a table and as a plot."""

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from reliab.assessment.cautions import cautions
from reliab.assessment.doubts import probability_text
from reliab.assessment.findings import Findings
from reliab.assessment.summary import summarise
from reliab.html_table import html_table
from reliab.significant import percent_with_interval, significant
from reliab.vocabulary import MILLI

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Assessment(Findings):
    """What is found about a test; see :class:`reliab.assessment.findings.Findings`."""

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Warnings to read before relying on the verdict, in sentences."""
        return cautions(self)

    def to_dict(self) -> dict[str, Any]:
        """Put everything into plain numbers with stable keys; see `reliab.assessment.summary`."""
        return {**summarise(self), "warnings": list(self.warnings)}

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the error over time: x_m − x_I [mm] over [s] with its 90 % band.

        Dashed: the threshold times the peak of the exact response.
        """
        from matplotlib import pyplot as plt

        shown = plt.subplots(figsize=(8.0, 3.0))[1] if axes is None else axes
        rebuilt = self.error.rebuilt
        time = np.arange(rebuilt.error.size) * rebuilt.time_step
        bound = MILLI * self.error.threshold * float(np.abs(rebuilt.reference).max())
        shown.fill_between(time, MILLI * rebuilt.low, MILLI * rebuilt.high, alpha=0.3, label="90 % band")
        shown.plot(time, MILLI * rebuilt.smooth_error, linewidth=0.8, label="rebuilt error")
        for sign in (-1.0, 1.0):
            shown.axhline(sign * bound, color="0.3", linewidth=0.8, linestyle="--")
        shown.set(xlabel="time [s]", ylabel="x_m − x_I [mm]", title=self.recording.name)
        shown.legend(frameon=False)
        return shown

    def __repr__(self) -> str:
        error = self.error.rebuilt.rms
        return (
            f"<Assessment of {self.recording.name}: {str(self.verdict.word).replace('_', ' ')}, RMS error "
            f"{percent_with_interval(error.value, error.low, error.high)}>"
        )

    def _repr_html_(self) -> str:
        """Write verdict, error, A, d and index as a table for notebooks."""
        error, index = self.error, self.population.index
        rms, mte = error.rebuilt.rms, error.rebuilt.mte
        below = f"probability of an error below {significant(error.threshold)} {error.metric.upper()}"
        rows = {
            "verdict": str(self.verdict.word).replace("_", " "),
            below: probability_text(error.probability),
            "RMS error": percent_with_interval(rms.value, rms.low, rms.high),
            "largest error": percent_with_interval(mte.value, mte.low, mte.high),
            "amplitude A": f"{self.tracking.amplitude:.4f}",
            "equivalent delay d": f"{MILLI * self.tracking.delay:.3f} ms",
            "index by the criterion": "none" if index is None else significant(index),
        }
        return html_table(self.recording.name, rows, self.verdict.reasons)
