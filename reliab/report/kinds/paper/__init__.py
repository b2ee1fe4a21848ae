"""Report of the paper: everything that it prints."""

from reliab.report.kinds.paper.report import paper_report

__all__ = ["paper_report"]
