"""Kinds of studies, one per file."""

from typing import Final

from reliab.study.kinds.blind_evaluation import BlindEvaluationStudy
from reliab.study.kinds.criterion import CriterionStudy
from reliab.study.kinds.discrepancy import DiscrepancyStudy
from reliab.study.kinds.kind import Kind
from reliab.study.kinds.paper import PaperStudy
from reliab.study.kinds.suites import SuitesStudy
from reliab.study.kinds.table_audit import TableAuditStudy
from reliab.study.kinds.validation import ValidationStudy

KINDS: Final[dict[str, type[Kind]]] = {
    each.name: each
    for each in (
        *(BlindEvaluationStudy, CriterionStudy, DiscrepancyStudy, PaperStudy),
        *(SuitesStudy, TableAuditStudy, ValidationStudy),
    )
}
"""Every kind by the name that a study's file gives it."""

__all__ = ["KINDS", "Kind"]
