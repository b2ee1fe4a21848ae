"""Reports of the paper: everything that it prints, and its Table 2 row by row."""

from reliab.report.kinds.paper.report import paper_report
from reliab.report.kinds.paper.rows_of_table_2 import table_2_report

__all__ = ["paper_report", "table_2_report"]
