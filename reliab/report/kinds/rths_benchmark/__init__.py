"""Report of the virtual hybrid-simulation benchmark."""

from reliab.report.kinds.rths_benchmark.report import rths_benchmark_report

__all__ = ["rths_benchmark_report"]
