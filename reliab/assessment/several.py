"""Verdicts on several tests, with the reasons why some could not be judged."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from reliab.assessment.assessment import Assessment
from reliab.assessment.frame_assessment import CoupledAssessment, FrameAssessment
from reliab.assessment.same_test import SameTest, combine_runs
from reliab.core.errors import InputError
from reliab.core.significant_digits import counted

if TYPE_CHECKING:
    import pandas as pd

_IN_NOTEBOOKS = ("verdict", "probability", "rms", "rms_low", "rms_high", "mte", "A", "d_ms", "fault")

_PLAIN: Final = (
    *("file", "test", "verdict", "probability", "metric", "threshold"),
    *("A", "d_ms", "index", "stability_margin"),
)
_ENDS: Final = ("value", "low", "high")


@dataclass(frozen=True, kw_only=True, eq=False)
class Assessments:
    """What is found about several tests."""

    files: tuple[str, ...]  # Files of the tests, in the order in which they were given
    # By file, what is found about the tests that could be judged
    judged: Mapping[str, Assessment | FrameAssessment | CoupledAssessment]
    faults: Mapping[str, str]  # By file, why the others could not be judged

    @property
    def reliable(self) -> bool:
        """Whether every test could be judged and is reliable."""
        return not self.faults and all(assessment.reliable for assessment in self.judged.values())

    def to_dict(self) -> dict[str, dict[str, Any]]:
        """By file, what is found in plain numbers; for a test that could not be judged, its `fault`."""
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

    def to_frame(self) -> "pd.DataFrame":
        """Put the verdicts into a table; see `reliab.assessment.several`."""
        return verdict_table({"file": file, **summary} for file, summary in self.to_dict().items())

    def __repr__(self) -> str:
        verdicts = [str(assessment.verdict.word).replace("_", " ") for assessment in self.judged.values()]
        counts = [f"{verdicts.count(word)} {word}" for word in ("reliable", "undecided", "not reliable")]
        judged = ", ".join([*counts, f"{len(self.faults)} not judged"])
        return f"<Assessments of {counted(len(self.files), 'test')}: {judged}>"

    def _repr_html_(self) -> str:
        """Table for notebooks."""
        shown = self.to_frame().set_index("file")[list(_IN_NOTEBOOKS)]
        return str(shown.to_html(na_rep="", float_format="{:.4g}".format))


def verdict_table(summaries: Iterable[Mapping[str, Any]]) -> "pd.DataFrame":
    """Put the answers about several tests into a table.

    Returns `file`, `test`, `verdict`, `probability` [-], `metric`, `threshold` [-], `A` [-], `d_ms` [ms],
    `index` [-], `stability_margin` [-], `rms`, `rms_low`, `rms_high`, `mte`, `mte_low`, `mte_high` [-],
    `reasons`, `warnings` and `fault`; empty where a value is unknown.

    >>> verdict_table([{"file": "a.csv", "fault": "It must not be empty."}]).loc[0, "fault"]
    'It must not be empty.'
    """
    import pandas as pd

    return pd.DataFrame([_row(summary) for summary in summaries])


def _row(summary: Mapping[str, Any]) -> dict[str, Any]:
    error = summary.get("error", {})
    sizes = {
        name if end == "value" else f"{name}_{end}": error.get(name, {}).get(end)
        for name in ("rms", "mte")
        for end in _ENDS
    }
    sentences = {name: " ".join(summary.get(name, ())) or None for name in ("reasons", "warnings")}
    return {
        **{name: summary.get(name) for name in _PLAIN},
        **sizes,
        **sentences,
        "fault": summary.get("fault"),
    }
