"""What is found about a test, in numbers and in words."""

from functools import cached_property
from typing import TYPE_CHECKING, Any

from reliab.assessment.cautions import cautions
from reliab.assessment.findings import Findings
from reliab.assessment.showing import draw_error, table_of_assessment
from reliab.assessment.summary import summarise
from reliab.significant import percent_with_interval

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
        """Draw the error over time; see :func:`reliab.assessment.showing.draw_error`."""
        return draw_error(self, axes)

    def __repr__(self) -> str:
        error = self.error.rebuilt.rms
        return (
            f"<Assessment of {self.recording.name}: {str(self.verdict.word).replace('_', ' ')}, RMS error "
            f"{percent_with_interval(error.value, error.low, error.high)}>"
        )

    def _repr_html_(self) -> str:
        """Table for notebooks."""
        return table_of_assessment(self)
