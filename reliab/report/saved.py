"""A report kept in a folder, from which it can be set without what it was made from.

The folder may come from somebody else. What is read of it is data: text, formulas of known words, and the
figures that the content names. Templates come from the package only.
"""

import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from reliab.core.described_files import parse_json
from reliab.core.file_limits import LIMITS
from reliab.core.files import decoding, folder_written_whole, ordinary
from reliab.core.untrusted_files import named_within
from reliab.report.content import CONTENT_FILE, files_of
from reliab.report.document import Document
from reliab.report.prose import require_formula

CONTENT_RULE: Final = "A report is set from its content as `reliab run` wrote it"
CONTENT_REMEDY: Final = "Run the study again with `reliab run`"

_FIGURE: Final = re.compile(r"figure-[0-9]{1,4}\.svg")
_FORMULAS: Final = {"math": "source", "equation": "math"}
"""Where parts of a kind hold their formula."""


def save_content(document: Document, folder: Path) -> None:
    """Keep what a report says, from which it can be set without what it was made from.

    `folder`: folder for its content and figures, replaced if it is there.
    """
    with folder_written_whole(folder) as unfinished:
        for name, content in files_of(document).items():
            (unfinished / name).write_bytes(content)
        shutil.rmtree(folder, ignore_errors=True)


def saved_content(folder: Path) -> dict[str, bytes]:
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
        checked = json.dumps(content, ensure_ascii=False, allow_nan=False).encode()
        return {CONTENT_FILE: checked} | {name: _figure(folder, name) for name in sorted(figures)}


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
    path = ordinary(named_within(folder, name, where=str(folder)))
    LIMITS["figure"].require_small(path)
    return path.read_bytes()
