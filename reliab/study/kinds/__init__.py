"""Kinds of studies, one per file."""

from typing import Final

from reliab.study.kinds import (
    blind_evaluation,
    criterion,
    discrepancy,
    paper,
    partitioned_structures,
    rths_benchmark,
    suites,
    table_audit,
    validation,
)
from reliab.study.kinds.kind import Kind

KINDS: Final[dict[str, Kind]] = {
    module.KIND.name: module.KIND
    for module in (
        *(blind_evaluation, criterion, discrepancy, paper, partitioned_structures),
        *(rths_benchmark, suites, table_audit, validation),
    )
}
"""Every kind by the name that a study's file gives it."""

__all__ = ["KINDS", "Kind"]
