"""Report of criteria for tests, and of why there is none."""

from reliab.report.kinds.criterion.refusal import no_criterion_report
from reliab.report.kinds.criterion.report import criterion_report

__all__ = ["criterion_report", "no_criterion_report"]
