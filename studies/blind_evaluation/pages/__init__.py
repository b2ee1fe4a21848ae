"""Report of how often diagnoses of campaigns with known, hidden effects were right."""

from ..pages.report import blind_evaluation_report

__all__ = ["blind_evaluation_report"]
