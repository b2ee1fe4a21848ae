"""Kinds of studies, one per file."""

from typing import Final

from reliab.registry import Registry
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

KINDS: Final[Registry[Kind]] = Registry(
    noun="kind of study",
    base=Kind,
    group="reliab.study_kinds",
    shipped=tuple(
        module.KIND
        for module in (
            *(blind_evaluation, criterion, discrepancy, paper, partitioned_structures),
            *(rths_benchmark, suites, table_audit, validation),
        )
    ),
    name_of=lambda kind: kind.name,
)
"""Every kind by the name that a study's file gives it; other packages register a `Kind`."""

__all__ = ["KINDS", "Kind"]
