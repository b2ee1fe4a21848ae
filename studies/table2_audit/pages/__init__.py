"""Report of the paper's Table 2, row by row."""

from ..pages.report import table_audit_report

__all__ = ["table_audit_report"]
