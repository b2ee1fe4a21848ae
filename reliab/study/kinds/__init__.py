"""Kinds of studies: those of this folder, those that studies bring with them, and those of other packages."""

from collections.abc import Iterator
from typing import Final

from reliab.core.registry import Registry
from reliab.study.description import StudyKind, folders_of_kinds, kind_of
from reliab.study.kinds import criterion, discrepancy


class _Kinds(Registry[StudyKind]):
    """Kinds by name; one that a study brings with it is imported when it is asked for."""

    def __getitem__(self, name: str) -> StudyKind:
        if name not in self._items and name in folders_of_kinds():
            kind = kind_of(folders_of_kinds()[name])
            if kind is not None:
                self.add(kind)
        return super().__getitem__(name)

    def __iter__(self) -> Iterator[str]:
        return iter({**self._items, **folders_of_kinds()})

    def __len__(self) -> int:
        return len({**self._items, **folders_of_kinds()})


KINDS: Final = _Kinds(
    noun="kind of study",
    base=StudyKind,
    group="reliab.study_kinds",
    items=(criterion.KIND, discrepancy.KIND),
    name_of=lambda kind: kind.name,
)
"""Every kind by the name that a study's file gives it; other packages register a `StudyKind`."""

__all__ = ["KINDS", "StudyKind"]
