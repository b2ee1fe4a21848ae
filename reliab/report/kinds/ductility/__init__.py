"""Report of what tests with nonlinear specimens tolerate."""

from reliab.report.kinds.ductility.report import ductility_report

__all__ = ["ductility_report"]
