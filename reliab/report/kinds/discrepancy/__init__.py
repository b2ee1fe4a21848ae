"""Report of a measured campaign: where the model fails, what is missing, and the proof."""

from reliab.report.kinds.discrepancy.report import discrepancy_report

__all__ = ["discrepancy_report"]
