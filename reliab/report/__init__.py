"""Figures and PDF reports of finished results; nothing is simulated here.

Importing this room draws nothing and loads no drawing library; the modules of `figures` do when they
are imported.
"""

from reliab.report.document import Document
from reliab.report.pdf import write_pdf

__all__ = ["Document", "write_pdf"]
