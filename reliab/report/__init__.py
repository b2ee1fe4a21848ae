"""Figures and PDF reports of finished results; nothing is simulated here."""

from reliab.report.document import Document
from reliab.report.pdf import write_pdf
from reliab.report.saved import save_content, saved_content
from reliab.report.setting import Setting

__all__ = ["Document", "Setting", "save_content", "saved_content", "write_pdf"]
