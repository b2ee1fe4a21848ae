"""Report of what predicts the error of partitioned tests."""

from ..pages.report import partitioned_structures_report

__all__ = ["partitioned_structures_report"]
