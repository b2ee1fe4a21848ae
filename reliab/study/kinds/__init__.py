"""Kinds of studies: every file of this folder holds one, its `KIND`; `kind.py` says what that is."""

from importlib import import_module
from pkgutil import iter_modules
from typing import Final

from reliab.registry import Registry
from reliab.study.kinds.kind import Kind

KINDS: Final[Registry[Kind]] = Registry(
    noun="kind of study",
    base=Kind,
    group="reliab.study_kinds",
    shipped=tuple(
        import_module(f"{__name__}.{file.name}").KIND
        for file in iter_modules(__path__)
        if file.name != "kind"
    ),
    name_of=lambda kind: kind.name,
)
"""Every kind by the name that a study's file gives it; other packages register a `Kind`."""

__all__ = ["KINDS", "Kind"]
