"""A report as an object: what it says in which order, and the literature it refers to."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

from reliab.core.described_files import read_toml
from reliab.criterion.scope import Provenance, read_versions
from reliab.report.numbers import Number
from reliab.report.prose import Prose, references, require_formula

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure as Drawing


@dataclass(frozen=True, kw_only=True)
class Points:
    """A list of points."""

    items: tuple[Prose, ...]  # One for each point


@dataclass(frozen=True, kw_only=True)
class Remark:
    """A short text that must not be overlooked."""

    text: Prose  # What it says


@dataclass(frozen=True, kw_only=True)
class Equation:
    """A numbered equation."""

    math: str  # The equation in typst's notation; written by the author of a report, not by its user
    label: str = ""  # What references call it

    def __post_init__(self) -> None:
        require_formula(self.math)


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column of a table."""

    key: str  # Column of the data frame
    heading: Prose  # What stands above it
    unit: str = ""  # Unit, which stands below the heading in brackets
    number: Number | None = None  # How its numbers are written; without it the values are text
    group: Prose = ""  # What stands above this and neighbouring columns of the same group
    wide: bool = False  # Whether it takes what width is left
    right: bool = False  # Whether its texts stand at the right on a terminal, as numbers do


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """A table; a column that its data frame lacks is a ValueError."""

    frame: "pd.DataFrame | Mapping[str, Sequence[str]]"  # The values by column
    columns: tuple[Column, ...]  # Which of its columns are shown, in their order
    caption: Prose  # What to see
    label: str = ""  # What references call it

    def __post_init__(self) -> None:
        if missing := [column.key for column in self.columns if column.key not in self.frame]:
            raise ValueError(f"A table's data frame must have its columns; {', '.join(missing)} is missing.")


def text_table(
    rows: Iterable[Sequence[str]],
    headings: Sequence[str] | Mapping[str, str],
    *,
    caption: Prose,
    label: str = "",
) -> Table:
    """Tabulate texts; a mapping says which headings stand "left" and which "right" on a terminal."""
    sides = headings if isinstance(headings, Mapping) else dict.fromkeys(headings, "left")
    names = list(headings)
    row_list = list(rows)
    frame = {str(place): [row[place] for row in row_list] for place in range(len(names))}
    columns = tuple(
        Column(key=str(place), heading=name, wide=place == 0, right=sides[name] == "right")
        for place, name in enumerate(names)
    )
    return Table(frame=frame, columns=columns, caption=caption, label=label)


@dataclass(frozen=True, kw_only=True, eq=False)
class Figure:
    """A figure."""

    drawing: "Drawing"  # What is drawn, at its size in print
    caption: Prose  # What to see
    label: str = ""  # What references call it
    # Whether it may stand at the top or bottom of a page, so that text fills the gap; never in a sheet
    floats: bool = False
    # Whether it stands on the first page, before the contents; at most one figure of a report
    leads: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Section:
    """A section, or a section of a section."""

    title: str  # Its heading
    blocks: "tuple[Block, ...]"  # What it holds
    label: str = ""  # What references call it
    # Whether it stands behind the others, in smaller type, beside words, provenance and references
    appendix: bool = False


Block = Prose | Points | Remark | Equation | Table | Figure | Section
"""What a report is built of; running text is a paragraph."""


@dataclass(frozen=True, kw_only=True)
class Source:
    """A source that a report refers to."""

    label: str  # What references call it
    text: str  # Authors, year, title and place


BACK_MATTER: Final = read_toml(
    Path(__file__).with_name("back_matter.toml"), rule="Not a file of reliab", remedy="Install it again"
)
"""Literature and words that stand at the end of a report which uses them."""

SOURCES: Final = tuple(
    Source(label=label, text=" ".join(text.split())) for label, text in BACK_MATTER["sources"].items()
)
"""The literature of the reports that ship."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Document:
    """A report; a label that is used twice or names nothing, or a second leading figure, is a ValueError.

    >>> report = Document(
    ...     kind="Reliability criterion", title="Example", verdict="Nothing was tested.",
    ...     blocks=(Section(title="Results", blocks=("None.",)),),
    ... )
    >>> report.sheet
    False
    """

    kind: str  # What it reports, "Reliability criterion"
    title: str  # Its title
    verdict: Prose  # The outcome in one sentence
    blocks: tuple[Block, ...]  # What it says
    # Whether the verdict is neither good nor bad, good, or bad
    tone: Literal["plain", "good", "bad"] = "plain"
    # What was asked and of what, for the first page; empty ones are left out
    facts: Mapping[str, Prose] = field(default_factory=dict)
    # Versions, checksums and settings from which it can be made again
    provenance: Mapping[str, str] = field(default_factory=dict)
    sources: tuple[Source, ...] = SOURCES  # The references; those that are not referred to are left out
    sheet: bool = False  # Whether it is a sheet of a page or two, without a title page and contents

    def __post_init__(self) -> None:
        labels = Counter([*_labels(self.blocks), *(source.label for source in self.sources)])
        twice = sorted(label for label, count in labels.items() if count > 1)
        unknown = sorted(set(self.list_references()) - set(labels))
        for rule, faulty in (("be used once", twice), ("name something in the report", unknown)):
            if faulty:
                raise ValueError(f"A label must {rule}; {', '.join(faulty)} does not.")
        if sum(figure.leads for figure in _figures(self.blocks)) > 1:
            raise ValueError("One figure stands on the first page; two are marked so.")

    def leading_figure(self) -> Figure | None:
        """Figure of the first page, if there is one."""
        return next((figure for figure in _figures(self.blocks) if figure.leads), None)

    def list_references(self) -> tuple[str, ...]:
        """Labels that the text refers to, in the order in which it does."""
        texts = [self.verdict, *self.facts.values(), *_texts(self.blocks)]
        return tuple(dict.fromkeys(label for text in texts for label in references(text)))


def _figures(blocks: Iterable[Block]) -> Iterator[Figure]:
    for block in blocks:
        if isinstance(block, Section):
            yield from _figures(block.blocks)
        elif isinstance(block, Figure):
            yield block


def _labels(blocks: Iterable[Block]) -> Iterator[str]:
    for block in blocks:
        if isinstance(block, Section):
            yield from _labels(block.blocks)
        if isinstance(block, Section | Figure | Table | Equation) and block.label:
            yield block.label


def _texts(blocks: Iterable[Block]) -> Iterator[Prose]:
    for block in blocks:
        match block:
            case Section():
                yield from _texts(block.blocks)
            case str() | tuple():
                yield block
            case Remark():
                yield block.text
            case Points():
                yield from block.items
            case Table():
                yield block.caption
                yield from (column.heading for column in block.columns)
            case Figure():
                yield block.caption


def provenance_of(
    settings_by_name: Mapping[str, object], criterion: Provenance | None = None
) -> dict[str, str]:
    """Collect versions, checksums and settings.

    `settings_by_name`: what the caller knows, by its name: the hash of the study, seeds, …; shown first.
    """
    lines = {name: _line(value) for name, value in settings_by_name.items()}
    if criterion is None:
        return {"packages": _line(read_versions()), **lines}
    settings = _line(criterion.settings)
    derivations = {
        "source": criterion.source,
        "motions, earthquakes": f"{criterion.n_motions}, {criterion.n_events}",
        "records, SHA-256": criterion.records_checksum,
        "window": criterion.window,
        "settings of the method": settings,
        "packages": _line(criterion.packages),
    }
    return {**lines, **{name: text for name, text in derivations.items() if text and name not in lines}}


def _line(value: object) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{str(name).replace('_', ' ')} {_line(item)}" for name, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(_line(item) for item in value)
    return f"{value:g}" if isinstance(value, float) else str(value)
