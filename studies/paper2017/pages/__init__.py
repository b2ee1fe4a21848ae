"""Report of the paper: everything that it prints."""

from ..pages.report import paper_report

__all__ = ["paper_report"]
