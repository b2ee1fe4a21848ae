"""A report as plain data and files for the template.

Text travels as JSON strings, which typst takes for text and never for markup; only mathematics, which
the authors of reports write, is evaluated.
"""

import json
from collections.abc import Iterable, Sequence
from typing import Any, Final

from reliab.report.document import (
    Block,
    Column,
    Document,
    Equation,
    Figure,
    Paragraph,
    Points,
    Remark,
    Section,
    Source,
    Table,
)
from reliab.report.glossary import glossary_of
from reliab.report.numbers import Written, cells
from reliab.report.prose import Math, Piece, Prose, Reference, Strong, literal, plain_text
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
        referred = document.referred()
        cited = [source for source in document.sources if source.label in referred]
        self._sources: list[Source] = sorted(cited, key=lambda source: referred.index(source.label))
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
            "blocks": self._blocks(block for block in document.blocks if not _appended(block)),
            "appendix": self._blocks(filter(_appended, document.blocks)),
            "sources": [{"label": source.label, "text": literal(source.text)} for source in self._sources],
            "provenance": [[literal(name), literal(text)] for name, text in document.provenance.items()],
            "sheet": document.sheet,
        }
        text = json.dumps(content, ensure_ascii=False)
        terms = [[self._prose(term.name), self._prose(term.meaning)] for term in glossary_of(text)]
        whole = json.dumps({**content, "glossary": terms}, ensure_ascii=False)
        return {CONTENT_FILE: whole.encode(), **self._figures}

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
            case Paragraph() | Remark():
                kind = "paragraph" if isinstance(block, Paragraph) else "remark"
                return {"kind": kind, "text": self._prose(block.text)}
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
                    "new_page": block.new_page and self._document.sheet,
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
            map(_cell, cells(table.frame[column.key].tolist(), column.number)) for column in table.columns
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


def _appended(block: Block) -> bool:
    return isinstance(block, Section) and block.appendix


def _cell(cell: str | tuple[Written, str]) -> dict[str, Any]:
    if isinstance(cell, str):
        return {"text": literal(cell)}
    written, lacks = cell
    return {"digits": written.digits, "exponent": written.exponent, "lacks": lacks}
