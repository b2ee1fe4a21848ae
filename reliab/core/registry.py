"""What the package and others that are installed beside it offer of one kind, by name."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, cached_property
from importlib.metadata import EntryPoint, entry_points
from typing import Protocol, TypeVar

from reliab.core.errors import InputError

Item = TypeVar("Item")


class Selectable(Protocol):
    """What Python's versions have in common of what packages register."""

    def select(self, *, group: str) -> Iterable[EntryPoint]:
        """Entries of a group."""


@cache
def read_entry_points() -> Selectable:
    """Read what installed packages register, of every kind, by one look into the folders of all of them."""
    return entry_points()


class Registry(Mapping[str, Item]):
    """Items of this package, then those of other packages; these are loaded when a name is first asked for.

    >>> from fractions import Fraction
    >>> halves = Registry(
    ...     noun="fraction", base=Fraction, group="example", items=(Fraction(1, 2),), name_of=str
    ... )
    >>> halves.find("1/2")
    Fraction(1, 2)
    """

    def __init__(
        self, *, noun: str, base: type, group: str, items: tuple[Item, ...], name_of: Callable[[Item], str]
    ) -> None:
        self._noun, self._base, self._group = noun, base, group
        self._shipped, self._name_of = items, name_of

    def add(self, item: Item) -> None:
        """Offer an item in this process, in place of one of the same name."""
        self._items[self._name_of(item)] = item

    def find(self, name: object) -> Item:
        """Return the item of a name."""
        if not isinstance(name, str) or name not in self:
            raise InputError(f"Unknown {self._noun}", value=name, remedy=f"Choose among {', '.join(self)}")
        return self[name]

    @property
    def _phrase(self) -> str:
        return f"{'An' if self._noun[0] in 'aeiou' else 'A'} {self._noun}"

    @cached_property
    def _items(self) -> dict[str, Item]:
        items = {self._name_of(item): item for item in self._shipped}
        for entry in read_entry_points().select(group=self._group):
            item = entry.load()
            if not issubclass(item if isinstance(item, type) else type(item), self._base):
                raise InputError(
                    f"What is registered under {self._group} must be {self._phrase.lower()}, derived from "
                    f"{self._base.__name__}",
                    value=repr(item),
                    remedy="Repair or remove the package that registers it",
                    where=entry.value,
                )
            name = self._name_of(item)
            if name in items:
                raise InputError(
                    f"The name of {self._phrase.lower()} must be unique",
                    value=name,
                    remedy=f"Rename the added {self._noun}",
                    where=entry.value,
                )
            items[name] = item
        return items

    def __getitem__(self, name: str) -> Item:
        return self._items[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)
