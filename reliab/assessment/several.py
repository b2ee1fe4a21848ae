"""Verdicts on several tests, with the reasons why some could not be judged."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from reliab.assessment.assessment import Assessment
from reliab.assessment.frame_assessment import FrameAssessment
from reliab.assessment.judged_test import plot_errors, verdict_table
from reliab.assessment.same_test import SameTest, combine_runs
from reliab.assessment.verdict import Word, probability_text
from reliab.core.columns import Columns
from reliab.core.errors import InputError
from reliab.core.plain_values import ResultWithRows
from reliab.core.significant_digits import counted, percent_and_interval

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


def _size(test: Mapping[str, Any], write: Callable[[Mapping[str, Any]], str]) -> str:
    """Write the error of a test that was asked for; nothing where it could not be judged."""
    return "" if "fault" in test else write(test["error"][test["metric"]])


@dataclass(frozen=True, kw_only=True, eq=False)
class Assessments(ResultWithRows):
    """What is found about several tests."""

    table_columns: ClassVar[Columns] = {
        "test": ("file", ""),
        "verdict": ("verdict", lambda word: Word(word).phrase if word else "not judged", "left"),
        "error": ("", lambda test: _size(test, lambda size: percent_and_interval(**size)[0])),
        "90 % interval": (
            "",
            lambda test: _size(test, lambda size: percent_and_interval(**size)[1]),
        ),
        "probability": ("probability", lambda share: "" if share is None else probability_text(share)),
        "A": ("A", lambda gain: "" if gain is None else f"{gain:.5f}"),
        "d, ms": ("d_ms", lambda delay: "" if delay is None else f"{delay:.4f}"),
    }

    files: tuple[str, ...]  # Files of the tests, in the order in which they were given
    # By file, what is found about the tests that could be judged
    judged: Mapping[str, Assessment | FrameAssessment]
    faults: Mapping[str, str]  # By file, why the others could not be judged

    @property
    def reliable(self) -> bool:
        """Whether every test could be judged and is reliable."""
        return not self.faults and all(assessment.reliable for assessment in self.judged.values())

    def to_dict(self) -> dict[str, dict[str, Any]]:
        """By file, what is found in plain numbers; for a test that could not be judged, its `fault`."""
        # By hand, since the keys are files.
        return {
            file: {"fault": self.faults[file]} if file in self.faults else self.judged[file].to_dict()
            for file in self.files
        }

    def same_test(self) -> SameTest:
        """Judge the tests as runs of one test; see `reliab.assessment.same_test`."""
        if self.faults:
            file, reason = next(iter(self.faults.items()))
            raise InputError(f"This run cannot be judged. {reason.rstrip('.')}", where=file)
        runs = {file: run for file, run in self.judged.items() if isinstance(run, Assessment)}
        if len(runs) < len(self.judged):
            raise InputError(
                "Only runs with one actuator can be combined",
                value="a frame",
                remedy="Leave `structure` out, or judge each run by itself",
            )
        return combine_runs(runs)

    def plain_rows(self) -> list[dict[str, Any]]:
        """Give what is found about each test, or its `fault`, with its `file`."""
        return [{"file": file, **content} for file, content in self.to_dict().items()]

    def to_dataframe(self) -> "pd.DataFrame":
        """Put the verdicts into a table, one row for each test; see :func:`verdict_table`."""
        return verdict_table(self.plain_rows())

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the error of each judged test with its 90 % interval [%], and the threshold."""
        errors = {file: test.error.estimate(test.metric) for file, test in self.judged.items()}
        first = next(iter(self.judged.values()))
        return plot_errors(errors, first.metric, first.threshold, axes)

    def __repr__(self) -> str:
        words = [test.verdict for test in self.judged.values()]
        counts = [f"{words.count(word)} {word.phrase}" for word in Word]
        counts_text = ", ".join([*counts, f"{len(self.faults)} not judged"])
        return f"<Assessments of {counted(len(self.files), 'test')}: {counts_text}>"
