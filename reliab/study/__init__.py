"""Declarative studies: a TOML file, run in stages, that ends in a report."""

from reliab.study.description import Study
from reliab.study.reading import open_study, read_study, shipped_studies, study_from
from reliab.study.running import run_study, write_report

__all__ = [
    "Study",
    "open_study",
    "read_study",
    "run_study",
    "shipped_studies",
    "study_from",
    "write_report",
]
