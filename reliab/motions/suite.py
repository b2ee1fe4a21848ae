"""Suites of ground motions, read one at a time."""

from collections import Counter
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import TYPE_CHECKING, ClassVar, Protocol, overload

from reliab.core.errors import InputError
from reliab.core.plain_values import Keys, ResultWithRows, html_table
from reliab.core.significant_digits import counted
from reliab.motions.motion import Motion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MOST_ROWS = 100  # motions in a table


class MotionEntry(Protocol):
    """A motion of a suite before it is read."""

    @property
    def name(self) -> str:
        """Unique name within the suite."""

    @property
    def event(self) -> str:
        """The earthquake."""

    @property
    def set_name(self) -> str:
        """Set of the catalogue; may be empty."""

    def load(self) -> Motion:
        """Read the motion."""


class MotionSuite(Sequence[Motion], ResultWithRows):
    """An ordered suite of motions with unique names.

    Names, events and sets are known from the start; a record is read when its motion is needed and is not
    kept, so that only one motion at a time is in memory.

    Parameters
    ----------
    entries : iterable of MotionEntry
        One entry for each motion, which reads it on demand.

    Raises
    ------
    InputError
        If two entries have the same name.

    Examples
    --------
    >>> pulse = Motion(name="pulse", acceleration=[0.0, 1.0, 0.0], time_step=0.01, event="test")
    >>> suite = MotionSuite.from_motions([pulse])
    >>> len(suite), suite.names, suite.events, suite[0].duration
    (1, ('pulse',), ('test',), 0.02)
    """

    rows_in = "motions"
    keys: ClassVar[Keys] = {
        "motions": ("entries", {"motion": "name", "event": "event", "set": "set_name"})  # no record is read
    }

    def __init__(self, entries: Iterable[MotionEntry]) -> None:
        self._entries = tuple(entries)
        duplicates = [name for name, count in Counter(self.names).items() if count > 1]
        if duplicates:
            raise InputError(
                "Several motions have the same name",
                value=", ".join(duplicates[:3]),
                remedy="Load the sources one by one, or name the motions in a catalogue",
            )

    @classmethod
    def from_motions(cls, motions: Iterable[Motion]) -> "MotionSuite":
        """Make a suite of motions that are in memory."""
        return cls(motions)

    @property
    def entries(self) -> tuple[MotionEntry, ...]:
        """Entries of the motions, in order."""
        return self._entries

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the motions, in order."""
        return tuple(entry.name for entry in self._entries)

    @property
    def events(self) -> tuple[str, ...]:
        """Earthquakes of the motions, in order; one name for several components of an earthquake."""
        return tuple(entry.event for entry in self._entries)

    @property
    def set_names(self) -> tuple[str, ...]:
        """Sets of the motions, in order; empty where a motion belongs to none."""
        return tuple(entry.set_name for entry in self._entries)

    def select(
        self, *, names: Iterable[str] | None = None, sets: Iterable[str] | None = None
    ) -> "MotionSuite":
        """Keep the motions of given names or sets, in the order of the suite.

        `names`, `sets`: what to keep; None keeps all. Returns the motions that have one of the names and one
        of the sets.
        """
        kept_names = _require_names(names, self.names, "motion")
        kept_sets = _require_names(sets, self.set_names, "set")
        return MotionSuite(
            entry for entry in self._entries if entry.name in kept_names and entry.set_name in kept_sets
        )

    def __len__(self) -> int:
        return len(self._entries)

    @overload
    def __getitem__(self, index: int) -> Motion: ...

    @overload
    def __getitem__(self, index: slice) -> "MotionSuite": ...

    def __getitem__(self, index: int | slice) -> "Motion | MotionSuite":
        if isinstance(index, slice):
            return MotionSuite(self._entries[index])
        return self._entries[index].load()

    def __repr__(self) -> str:
        return (
            f"<MotionSuite of {counted(len(self), 'motion')} from {counted(len(set(self.events)), 'event')}>"
        )

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the peak acceleration of each motion over its duration, and return the axes.

        `axes`: those to draw into; new ones by default. Reads one record after the other.
        """
        from matplotlib import pyplot as plt

        drawn = axes if axes is not None else plt.figure(layout="constrained").gca()
        points = [(motion.duration, motion.peak_acceleration) for motion in self]
        drawn.plot(*zip(*points, strict=True), "o")
        drawn.set(xlabel="duration [s]", ylabel="peak ground acceleration [m/s²]")
        return drawn

    def _repr_html_(self) -> str:
        """Table for notebooks: motions by earthquake; no record is read."""
        motions: dict[str, list[str]] = {}
        for entry in self._entries[:_MOST_ROWS]:
            motions.setdefault(entry.event, []).append(entry.name)
        rows = {event: ", ".join(names) for event, names in motions.items()}
        remainder = [f"… and {len(self) - _MOST_ROWS} more"] if len(self) > _MOST_ROWS else []
        return html_table(repr(self).strip("<>"), rows, remainder)


def _require_names(
    wanted_names: Iterable[str] | None, present: tuple[str, ...], description: str
) -> set[str]:
    """Return the names or sets asked for, all of which must be in the suite."""
    if wanted_names is None:
        return set(present)
    names = {wanted_names} if isinstance(wanted_names, str) else set(wanted_names)
    unknown = sorted(names - set(present))
    if unknown:
        choices = sorted({name for name in present if name})
        close = get_close_matches(unknown[0], choices, n=3, cutoff=0.4) or choices[:5]
        raise InputError(
            f"No {description} {unknown[0]!r} in the suite",
            remedy=f"Choose for example {', '.join(close)}" if close else f"The suite has no {description}s",
        )
    return names
