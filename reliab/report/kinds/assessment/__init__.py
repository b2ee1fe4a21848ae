"""Report of one measured test."""

from reliab.report.kinds.assessment.report import assessment_report

__all__ = ["assessment_report"]
