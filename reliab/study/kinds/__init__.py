"""Kinds of studies: those of this folder, those that studies bring with them, and those of other packages."""

from typing import Final

from reliab.core.registry import Registry
from reliab.study.folders import shipped_kinds
from reliab.study.kind import Kind
from reliab.study.kinds import criterion, discrepancy

KINDS: Final[Registry[Kind]] = Registry(
    noun="kind of study",
    base=Kind,
    group="reliab.study_kinds",
    shipped=(criterion.KIND, discrepancy.KIND, *shipped_kinds()),
    name_of=lambda kind: kind.name,
)
"""Every kind by the name that a study's file gives it; other packages register a `Kind`."""

__all__ = ["KINDS", "Kind"]
