"""What is found about a test, in numbers and in words."""

from functools import cached_property
from typing import Any

from reliab.validation.assessment.cautions import cautions
from reliab.validation.assessment.findings import Findings
from reliab.validation.assessment.summary import summarise


class Assessment(Findings):
    """What is found about a test; see :class:`reliab.validation.assessment.findings.Findings`."""

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What should be known before the verdict is relied on, in sentences."""
        return cautions(self)

    def to_dict(self) -> dict[str, Any]:
        """Put everything into plain numbers with stable keys; see `reliab.validation.assessment.summary`."""
        return {**summarise(self), "warnings": list(self.warnings)}
