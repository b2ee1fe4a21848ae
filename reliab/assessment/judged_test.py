"""A test with its verdict, and how every such result shows itself: as text, table, plot and in a notebook."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self

import numpy as np

from reliab.assessment import brief
from reliab.assessment.conflicts import OwnEquation
from reliab.assessment.error_of_test import ErrorOfTest, Question
from reliab.assessment.faults import FaultEffect
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.assessment.recorded_force import ExaminedForce
from reliab.assessment.tracking_index import TrackingIndex
from reliab.assessment.turning import Turning
from reliab.assessment.verdict import Contradiction, Doubt, Verdict, Word, probability_text
from reliab.core.plain_values import Keys, PlainResult, html_table, same_names
from reliab.core.significant_digits import percent, percent_with_interval, significant
from reliab.core.vocabulary import ERROR_NAMES, MILLI, PERCENT, Metric
from reliab.criterion.criterion import Criterion
from reliab.recordings.recording import Recording

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from reliab.assessment.own_motion import OwnPlacement
    from reliab.motions.motion import Motion

_COLUMNS: Final = (
    *("test", "verdict", "probability", "metric", "threshold"),
    *("A", "d_ms", "index", "stability_margin"),
)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class JudgedTest(PlainResult):
    """A test with its error and the verdict on it."""

    keys: ClassVar[Keys] = {
        "test": "recording.name",
        **same_names("metric", "threshold", "verdict", "reliable", "reasons", "would_decide", "probability"),
        "error": "error",
        "budget": "error.budget",
        "faults": "faults",
        "recording": {"channels": "recording.channels"},
        "duration_s": "recording.duration",
        "rate_hz": "recording.rate",
        "notes": "recording.notes",
        "warnings": "warnings",
    }

    recording: Recording  # The test
    sound: Recording  # The same without its faults
    question: Question  # What is stated of it, and what was identified where nothing was
    criterion: Criterion | None  # The criterion beside which it is shown, if there is one
    motion: "Motion | None"  # Its ground motion, where it is given
    tracking: TrackingIndex | None  # A and d with their uncertainty; None where there are several actuators
    error: ErrorOfTest  # The error, from the test alone
    faults: tuple[FaultEffect, ...]  # Faults of the recording and what they do to the error
    equation: OwnEquation  # What the test's equation of motion shows about the structure
    turning: Turning  # What was not stated and would turn the verdict
    column_doubts: tuple[Contradiction, ...]  # Why command and measured displacement may be swapped
    judgement: Verdict  # The verdict with its reasons, by the error alone before doubts are added
    examined_force: ExaminedForce | None = None  # Its recorded force, if one actuator has one
    # The test against the boundary of its own ground motion, where that is known
    placement: "OwnPlacement | None" = None
    doubts: tuple[Doubt, ...] = ()  # What leaves the verdict undecided

    def add_doubts(self, doubts: Iterable[Doubt]) -> Self:
        """Add what leaves the verdict undecided."""
        found = tuple(doubts)
        return replace(self, doubts=found, judgement=self.judgement.limit(found))

    @property
    def stability_margin(self) -> float | None:
        """Stability margin [-]; None where the loop is unstable with any delay."""
        return 1.0

    @property
    def contradictions(self) -> tuple[Contradiction, ...]:
        """Where the recording contradicts what is stated."""
        return tuple(doubt for doubt in self.doubts if isinstance(doubt, Contradiction))

    @property
    def verdict(self) -> Word:
        """What the verdict says, "reliable", "undecided" or "not_reliable"."""
        return self.judgement.word

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why the verdict is what it is, in sentences."""
        return self.judgement.reasons

    @property
    def would_decide(self) -> tuple[str, ...]:
        """What to do about an undecided test, in sentences."""
        return self.judgement.would_decide

    @property
    def reliable(self) -> bool:
        """Whether the verdict is "reliable"."""
        return self.judgement.reliable

    @property
    def metric(self) -> Metric:
        """Which error is asked about."""
        return self.error.metric

    @property
    def threshold(self) -> float:
        """Largest error of a reliable test [-]."""
        return self.error.threshold

    @property
    def probability(self) -> float:
        """Probability that the error of the test stays below the threshold."""
        return self.error.probability

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings to read before relying on the verdict, in sentences."""
        return ()

    def to_dataframe(self) -> "pd.DataFrame":
        """Put verdict, error, A, d and index into a table of one row."""
        import pandas as pd

        return pd.DataFrame([_row(self.to_dict())])

    def summary(self) -> str:
        """Say verdict, error, what to improve and what to do next, a sentence in each line."""
        content = self.to_dict()
        return "\n".join((brief.headline(content), *brief.findings(content), *brief.actions(content)))

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the error over time, x_m − x_I [mm] over [s], with its 90 % band.

        Dashed: the threshold times the peak of the exact response. Of several displacements the one with
        the largest error is drawn.
        """
        from matplotlib import pyplot as plt

        figure_axes = plt.subplots(figsize=(8.0, 3.0), layout="constrained")[1] if axes is None else axes
        displacement = self.error.governing or self.error.displacements[0]
        time = np.arange(displacement.error.size) * self.recording.time_step
        bound = MILLI * self.threshold * float(np.abs(displacement.reference).max())
        low, high = MILLI * displacement.low, MILLI * displacement.high
        figure_axes.fill_between(time, low, high, alpha=0.3, label="90 % band")
        figure_axes.plot(time, MILLI * displacement.smooth_error, linewidth=0.8, label="rebuilt error")
        for sign in (-1.0, 1.0):
            figure_axes.axhline(sign * bound, color="0.3", linewidth=0.8, linestyle="--")
        figure_axes.set(
            xlabel="time [s]",
            ylabel="$x_m - x_I$ [mm]",
            title=f"{self.recording.name}{self.error.displacement_suffix}",
        )
        figure_axes.legend(frameon=False)
        return figure_axes

    def __repr__(self) -> str:
        about = f"{type(self).__name__} of {self.recording.name}: {self.verdict.phrase}"
        size = self.error.estimate(self.metric)
        if math.isnan(size.value):
            return f"<{about}, all motion is lost in noise>"
        interval = percent_with_interval(size.value, size.low, size.high)
        return f"<{about}, {ERROR_NAMES[self.metric]}{self.error.displacement_suffix} {interval}>"

    def _repr_html_(self) -> str:
        """Write verdict, error, A, d and index as a table for notebooks."""
        content = self.to_dict()
        label = f"probability that the {ERROR_NAMES[self.metric]} is below {percent(self.threshold)}"
        rows = {"verdict": self.verdict.phrase, label: probability_text(self.probability)}
        for metric, name in ERROR_NAMES.items():
            size = content["error"][metric]
            rows[name] = "unknown" if size["value"] is None else percent_with_interval(**size)
        rows["amplitude A"] = f"{content['A']:.4f}"
        rows["equivalent delay d"] = f"{content['d_ms']:.3f} ms"
        if content.get("by_index"):
            index = content["by_index"]["index"]
            rows["index by the criterion"] = "none" if index is None else significant(index)
        return html_table(self.recording.name, rows, self.reasons)


def verdict_table(contents: Iterable[Mapping[str, Any]]) -> "pd.DataFrame":
    """Put the answers about several tests into a table.

    Returns `file`, `test`, `verdict`, `probability` [-], `metric`, `threshold` [-], `A` [-], `d_ms` [ms],
    `index` [-], `stability_margin` [-], `rms`, `rms_low`, `rms_high`, `mte`, `mte_low`, `mte_high` [-],
    `reasons`, `warnings` and `fault`; empty where a value is unknown.

    >>> verdict_table([{"file": "a.csv", "fault": "It must not be empty."}]).loc[0, "fault"]
    'It must not be empty.'
    """
    import pandas as pd

    return pd.DataFrame(
        [{"file": content["file"], **_row(content), "fault": content.get("fault")} for content in contents]
    )


def _row(content: Mapping[str, Any]) -> dict[str, Any]:
    error = content.get("error", {})
    sizes = {
        name if end == "value" else f"{name}_{end}": error.get(name, {}).get(end)
        for name in Metric
        for end in ("value", "low", "high")
    }
    sentences = {name: " ".join(content.get(name, ())) or None for name in ("reasons", "warnings")}
    return {**{name: content.get(name) for name in _COLUMNS}, **sizes, **sentences}


def plot_errors(
    errors: Mapping[str, Estimate], metric: Metric, threshold: float, axes: "Axes | None" = None
) -> "Axes":
    """Draw the errors of tests with their 90 % intervals [%] from top to bottom, and the threshold."""
    from matplotlib import pyplot as plt

    height = 1.2 + 0.3 * len(errors)
    figure_axes = plt.subplots(figsize=(8.0, height), layout="constrained")[1] if axes is None else axes
    sizes = PERCENT * np.array([(size.low, size.value, size.high) for size in errors.values()])
    rows: Sequence[int] = range(len(errors))
    figure_axes.hlines(rows, sizes[:, 0], sizes[:, 2], label="90 % interval")
    figure_axes.plot(sizes[:, 1], rows, "o", label="error of the whole test")
    figure_axes.axvline(PERCENT * threshold, color="0.3", linestyle="--", label="threshold")
    figure_axes.set_yticks(rows, list(errors))
    figure_axes.invert_yaxis()
    figure_axes.set_xlim(left=0.0)
    figure_axes.set_xlabel(f"{ERROR_NAMES[Metric(metric)]} of the whole test [%]")
    figure_axes.legend(frameon=False)
    return figure_axes
