"""Report that compares suites of ground motions."""

from reliab.report.kinds.suites.report import suites_report

__all__ = ["suites_report"]
