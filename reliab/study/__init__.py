"""Declarative studies: a TOML file, run in stages, that ends in a report."""

from reliab.study.description import Study, read_study
from reliab.study.running import open_study, run_study, shipped_studies, write_report

__all__ = ["Study", "open_study", "read_study", "run_study", "shipped_studies", "write_report"]
