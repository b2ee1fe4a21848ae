"""Report of whether criteria keep their promise on motions that they were not learned from."""

from reliab.report.kinds.validation.report import validation_report

__all__ = ["validation_report"]
