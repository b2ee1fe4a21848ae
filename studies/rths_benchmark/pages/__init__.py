"""Report of the virtual hybrid-simulation benchmark."""

from ..pages.report import rths_benchmark_report

__all__ = ["rths_benchmark_report"]
