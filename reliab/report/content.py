"""A report as plain data and files for the template.

Text travels as JSON strings, which typst takes for text and never for markup; only mathematics, which
the authors of reports write, is evaluated.

Content may be kept in a folder, from which a report can be set without what it was made from. The folder may
come from somebody else. What is read of it is data: text, formulas of known words, and the figures that the
content names. Templates come from the package only.
"""

import json
import re
import shutil
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

from reliab.core.described_files import parse_json
from reliab.core.files import LIMITS, decoding, folder_written_whole, ordinary
from reliab.core.untrusted_files import resolve_within
from reliab.report.document import (
    BACK_MATTER,
    Block,
    Column,
    Document,
    Equation,
    Figure,
    Points,
    Remark,
    Section,
    Source,
    Table,
)
from reliab.report.numbers import WrittenNumber, cells
from reliab.report.prose import (
    Math,
    Piece,
    Prose,
    Reference,
    Strong,
    literal,
    plain_text,
    prose,
    require_formula,
)
from reliab.report.style import svg

CONTENT_FILE: Final = "document.json"
"""What the template reads."""

_MILLIMETRES_PER_INCH: Final = 25.4


def files_of(document: Document) -> dict[str, bytes]:
    """Write what the template reads."""
    return _Writer(document).files()


class _Writer:
    """Writes the parts of one report; collects its figures on the way."""

    def __init__(self, document: Document) -> None:
        self._document = document
        references = document.list_references()
        cited_sources = [source for source in document.sources if source.label in references]
        self._sources: list[Source] = sorted(cited_sources, key=lambda source: references.index(source.label))
        self._numbers = {source.label: k for k, source in enumerate(self._sources, start=1)}
        self._figures: dict[str, bytes] = {}

    def files(self) -> dict[str, bytes]:
        document = self._document
        content = {
            "kind": literal(document.kind),
            "title": literal(document.title),
            "verdict": self._prose(document.verdict),
            "tone": document.tone,
            "facts": [[literal(name), self._prose(text)] for name, text in document.facts.items() if text],
            "leading": [self._figure(figure) for figure in [document.leading_figure()] if figure],
            "blocks": self._blocks(block for block in document.blocks if not _is_appended(block)),
            "appendix": self._blocks(filter(_is_appended, document.blocks)),
            "sources": [{"label": source.label, "text": literal(source.text)} for source in self._sources],
            "provenance": [[literal(name), literal(text)] for name, text in document.provenance.items()],
            "sheet": document.sheet,
        }
        text = json.dumps(content, ensure_ascii=False)
        terms = [[self._prose(term.name), self._prose(prose(term.meaning))] for term in glossary_of(text)]
        content_text = json.dumps({**content, "glossary": terms}, ensure_ascii=False)
        return {CONTENT_FILE: content_text.encode(), **self._figures}

    def _prose(self, text: Prose) -> list[dict[str, Any]]:
        return [self._piece(piece) for piece in ((text,) if isinstance(text, str) else text)]

    def _piece(self, piece: Piece) -> dict[str, Any]:
        match piece:
            case Math():
                return {"kind": "math", "source": piece.source}
            case Strong():
                return {"kind": "strong", "text": literal(piece.text)}
            case Reference() if piece.label in self._numbers:
                return {"kind": "source", "label": piece.label, "number": self._numbers[piece.label]}
            case Reference():
                return {"kind": "reference", "label": piece.label}
            case str():
                return {"kind": "text", "text": literal(piece)}

    def _blocks(self, blocks: Iterable[Block], level: int = 1) -> list[dict[str, Any]]:
        return [
            self._block(block, level) for block in blocks if not (isinstance(block, Figure) and block.leads)
        ]

    def _block(self, block: Block, level: int) -> dict[str, Any]:
        match block:
            case str() | tuple() | Remark():
                kind, text = ("remark", block.text) if isinstance(block, Remark) else ("paragraph", block)
                return {"kind": kind, "text": self._prose(text)}
            case Points():
                return {"kind": "points", "items": [self._prose(item) for item in block.items]}
            case Equation():
                return {"kind": "equation", "math": block.math, "label": block.label}
            case Table():
                return self._table(block)
            case Figure():
                return self._figure(block)
            case Section():
                inner = self._blocks(block.blocks, level + 1)
                title = literal(block.title)
                return {
                    "kind": "section",
                    "opens": level == 1 and not self._document.sheet,
                    "appendix": block.appendix,
                    "title": title,
                    "level": level,
                    "label": block.label,
                    "blocks": inner,
                }

    def _figure(self, figure: Figure) -> dict[str, Any]:
        name = f"figure-{len(self._figures) + 1}.svg"
        self._figures[name] = svg(figure.drawing)
        return {
            "kind": "figure",
            "file": name,
            "width": round(_MILLIMETRES_PER_INCH * float(figure.drawing.get_figwidth()), 3),
            "caption": self._prose(figure.caption),
            "alternative": plain_text(figure.caption),
            "label": figure.label,
            "floats": figure.floats and not self._document.sheet,
        }

    def _table(self, table: Table) -> dict[str, Any]:
        columns = [
            map(_cell, cells(list(table.frame[column.key]), column.number)) for column in table.columns
        ]
        return {
            "kind": "table",
            "caption": self._prose(table.caption),
            "label": table.label,
            "groups": self._groups(table.columns),
            "headings": [
                {
                    "heading": self._prose(column.heading),
                    "unit": literal(column.unit),
                    "numeric": column.number is not None,
                    "wide": column.wide,
                }
                for column in table.columns
            ],
            "rows": [list(row) for row in zip(*columns, strict=True)],
        }

    def _groups(self, columns: Sequence[Column]) -> list[dict[str, Any]]:
        """Group neighbouring columns, with the number of columns of each."""
        groups: list[dict[str, Any]] = []
        for rank, column in enumerate(columns):
            if rank and column.group and column.group == columns[rank - 1].group:
                groups[-1]["span"] += 1
            else:
                groups.append({"heading": self._prose(column.group), "span": 1, "named": bool(column.group)})
        return groups if any(group["named"] for group in groups) else []


def _is_appended(block: Block) -> bool:
    return isinstance(block, Section) and block.appendix


def _cell(cell: str | tuple[WrittenNumber, str]) -> dict[str, Any]:
    if isinstance(cell, str):
        return {"text": literal(cell)}
    text, lacks = cell
    return {"digits": text.digits, "exponent": text.exponent, "lacks": lacks}


CONTENT_RULE: Final = "A report is set from its content as `reliab run` wrote it"
CONTENT_REMEDY: Final = "Run the study again with `reliab run`"

_FIGURE: Final = re.compile(r"figure-[0-9]{1,4}\.svg")
_FORMULAS: Final = {"math": "source", "equation": "math"}
"""Where parts of a kind hold their formula."""


def save_content(document: Document, folder: Path) -> None:
    """Keep what a report says, from which it can be set without what it was made from.

    `folder`: folder for its content and figures, replaced if it is there.
    """
    with folder_written_whole(folder) as temporary:
        for name, content in files_of(document).items():
            (temporary / name).write_bytes(content)
        shutil.rmtree(folder, ignore_errors=True)


def read_content(folder: Path) -> dict[str, bytes]:
    """Read what :func:`save_content` kept: the content, and the figures that it names."""
    with decoding(CONTENT_RULE, remedy=CONTENT_REMEDY, where=folder):
        content = parse_json(
            _bytes_of(folder, CONTENT_FILE).decode(),
            rule=CONTENT_RULE,
            remedy=CONTENT_REMEDY,
            where=str(folder),
        )
        parts = list(_parts(content))
        for piece in parts:
            if key := _FORMULAS.get(piece.get("kind", "")):
                require_formula(piece[key])
        figures = {piece["file"] for piece in parts if piece.get("kind") == "figure"}
        # What was checked is what the template reads, not the bytes that it was decoded from.
        encoded = json.dumps(content, ensure_ascii=False, allow_nan=False).encode()
        return {CONTENT_FILE: encoded} | {name: _figure(folder, name) for name in sorted(figures)}


def _parts(content: object) -> Iterator[dict[str, Any]]:
    """Every object in a JSON document."""
    waiting = [content]
    while waiting:
        value = waiting.pop()
        if isinstance(value, dict):
            yield value
            waiting.extend(value.values())
        elif isinstance(value, list):
            waiting.extend(value)


def _figure(folder: Path, name: str) -> bytes:
    if not _FIGURE.fullmatch(name):
        message = f"a figure of the name {name!r}"
        raise ValueError(message)
    return _bytes_of(folder, name)


def _bytes_of(folder: Path, name: str) -> bytes:
    path = ordinary(resolve_within(folder, name, where=str(folder)))
    LIMITS["figure"].require_small(path)
    return path.read_bytes()


class Term(NamedTuple):
    """A word that is explained where a report uses it."""

    name: Prose  # The word, as it stands in the glossary
    pattern: str  # Regular expression of its forms in running text
    meaning: str  # What it means


TERMS: Final = tuple(
    Term(prose(row["name"]), row["pattern"], " ".join(row["meaning"].split())) for row in BACK_MATTER["terms"]
)
"""Words that are explained, in alphabetical order."""


def glossary_of(text: str) -> list[Term]:
    """Choose the words that a report uses.

    >>> [term.name for term in glossary_of("The stability margin of a held-out test")]
    [('held-out test',), ('stability margin',)]
    """
    return [term for term in TERMS if re.search(term.pattern, text)]
