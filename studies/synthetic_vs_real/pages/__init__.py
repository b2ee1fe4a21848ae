"""Report that compares suites of ground motions."""

from ..pages.report import suites_report

__all__ = ["suites_report"]
