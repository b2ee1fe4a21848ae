"""Report of specimens that are known by their force only."""

from ..pages.report import measured_specimen_report

__all__ = ["measured_specimen_report"]
