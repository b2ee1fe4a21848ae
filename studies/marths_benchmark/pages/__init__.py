"""Pages of the report of the multi-axial benchmark."""

from .report import marths_report

__all__ = ["marths_report"]
