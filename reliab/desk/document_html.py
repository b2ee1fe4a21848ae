"""A report's document as HTML: what the template of the PDF reads, rendered for a page."""

import base64
import json
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Any, Final

from reliab.report.content import CONTENT_FILE, files_of
from reliab.report.document import Document
from reliab.report.prose import formula

_LOWEST_HEADING: Final = 6
_PIXELS: Final = 4.6  # of a screen for a millimetre of print


def document_html(document: Document, *, heading: int = 2) -> str:
    """Render a document below a heading of a level; every text of it is escaped."""
    return _Renderer(files_of(document), heading).html()


class _Renderer:
    """Renders the content of one document."""

    def __init__(self, files: Mapping[str, bytes], heading: int) -> None:
        self._content: dict[str, Any] = json.loads(files[CONTENT_FILE])
        self._files, self._heading = files, heading

    def html(self) -> str:
        content = self._content
        facts = "".join(f"<dt>{escape(name)}</dt><dd>{_prose(text)}</dd>" for name, text in content["facts"])
        parts = [
            f'<p class="verdict {escape(content["tone"])}">{_prose(content["verdict"])}</p>',
            f"<dl>{facts}</dl>" if facts else "",
            *self._blocks(content["leading"]),
            *self._blocks(content["blocks"]),
            *self._blocks(content["appendix"]),
        ]
        return f'<div class="document">{"".join(parts)}</div>'

    def _blocks(self, blocks: Sequence[Mapping[str, Any]]) -> Iterator[str]:
        for block in blocks:
            yield self._block(block)

    def _block(self, block: Mapping[str, Any]) -> str:
        match block["kind"]:
            case "section":
                level = min(self._heading + int(block["level"]) - 1, _LOWEST_HEADING)
                inner = "".join(self._blocks(block["blocks"]))
                return f"<h{level}>{escape(block['title'])}</h{level}>{inner}"
            case "points":
                return f"<ul>{''.join(f'<li>{_prose(item)}</li>' for item in block['items'])}</ul>"
            case "equation":
                return f"<p><i>{escape(formula(block['math']))}</i></p>"
            case "table":
                return _table(block)
            case "figure":
                svg, width = self._files[block["file"]], float(block["width"])
                return _picture(svg, width, block["alternative"], _prose(block["caption"]))
            case _:
                return f"<p>{_prose(block['text'])}</p>"


def _picture(svg: bytes, width: float, alternative: str, caption: str) -> str:
    """Show a drawing of a width [mm] as a picture, in which no script can run; the caption is HTML."""
    data = base64.b64encode(svg).decode()
    image = (
        f'<img alt="{escape(alternative)}" width="{_PIXELS * width:.0f}" '
        f'src="data:image/svg+xml;base64,{data}">'
    )
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"


def _prose(pieces: Sequence[Mapping[str, Any]]) -> str:
    return "".join(map(_piece, pieces))


def _piece(piece: Mapping[str, Any]) -> str:
    match piece["kind"]:
        case "math":
            return f"<i>{escape(formula(piece['source']))}</i>"
        case "strong":
            return f"<b>{escape(piece['text'])}</b>"
        case "source":
            return f"[{piece['number']}]"
        case "reference":
            return "the figure or table" if ":" in piece["label"] else escape(piece["label"])
        case _:
            return escape(piece["text"])


def _table(block: Mapping[str, Any]) -> str:
    groups = "".join(
        f'<th colspan="{int(group["span"])}">{_prose(group["heading"])}</th>' for group in block["groups"]
    )
    top = "".join(map(_heading, block["headings"]))
    rows = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in block["rows"])
    error_figure = f"<tr>{groups}</tr>" if groups else ""
    return (
        f'<div class="wide" tabindex="0" role="group" aria-label="Table"><table>'
        f"<caption>{_prose(block['caption'])}</caption>"
        f"<thead>{error_figure}<tr>{top}</tr></thead><tbody>{rows}</tbody></table></div>"
    )


def _heading(heading: Mapping[str, Any]) -> str:
    unit = f" [{escape(heading['unit'])}]" if heading["unit"] else ""
    return f'<th scope="col">{_prose(heading["heading"])}{unit}</th>'


def _cell(cell: Mapping[str, Any]) -> str:
    if "text" in cell:
        return f"<td>{escape(cell['text'])}</td>"
    power = "" if cell["exponent"] is None else f" × 10<sup>{int(cell['exponent'])}</sup>"
    return f'<td class="number">{escape(cell["digits"])}{power}</td>'
