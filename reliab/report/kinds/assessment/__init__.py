"""Reports of one measured test, of one mass or of a frame."""

from reliab.report.kinds.assessment.frame import frame_assessment_report
from reliab.report.kinds.assessment.report import assessment_report

__all__ = ["assessment_report", "frame_assessment_report"]
