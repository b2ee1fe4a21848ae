"""Report of what tests with nonlinear specimens tolerate."""

from ..pages.report import ductility_report

__all__ = ["ductility_report"]
