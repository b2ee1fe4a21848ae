"""Report of what predicts the error of partitioned tests."""

from reliab.report.kinds.partitioned_structures.report import partitioned_structures_report

__all__ = ["partitioned_structures_report"]
