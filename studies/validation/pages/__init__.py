"""Report of whether criteria keep their promise on motions that they were not learned from."""

from ..pages.report import validation_report

__all__ = ["validation_report"]
