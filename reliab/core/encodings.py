"""Text between programs: its encodings; no cell is a formula, and no name steers a terminal."""

import codecs
import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import IO

from reliab.core.files import ordinary

_UNMARKED = re.compile(rb"\x00[\t\n\r -~]|[\t\n\r -~]\x00(?!\x00)")
_FORMULA = re.compile(r"'*(\s*[=+\-@＝＋－＠]|[\t\r\n])")
_EAST_ASIAN, _HEAD = ("cp932", "gb18030", "big5", "euc_kr"), 1 << 16  # and bytes in which words are counted
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


def encoding_of(head: bytes) -> str:
    r"""Name the encoding of a text: UTF-16, as from Windows, by its mark or its first character; else UTF-8.

    >>> encoding_of("f".encode("utf-16")), encoding_of(b"f\x00"), encoding_of(b"\x00f"), encoding_of(b"f,")
    ('utf-16', 'utf-16-le', 'utf-16-be', 'utf-8-sig')
    """
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if _UNMARKED.match(head):
        return "utf-16-be" if head[0] == 0 else "utf-16-le"
    return "utf-8-sig"


def encoding_of_file(path: str | Path) -> str:
    """Name the encoding of a text file, an ordinary one, as :func:`encoding_of` does."""
    with ordinary(path).open("rb") as file:
        return encoding_of(file.read(2))


def as_utf8(content: bytes) -> bytes:
    r"""Take the byte order mark from a text, and write UTF-16 as UTF-8.

    >>> as_utf8("f = 1 Hz".encode("utf-16")), as_utf8(b"\xef\xbb\xbff = 1 Hz"), as_utf8(b"\xb0")
    (b'f = 1 Hz', b'f = 1 Hz', b'\xb0')
    """
    encoding = encoding_of(content)
    if encoding.startswith("utf-16"):
        return content.decode(encoding, errors="replace").encode()
    return content.removeprefix(codecs.BOM_UTF8)


def pieces_as_utf8(pieces: Iterable[bytes]) -> Iterator[bytes]:
    """Write a text that comes in pieces as UTF-8; after an empty piece begins another, with its own mark."""
    decoder, begins = None, True
    for piece in pieces:
        if begins and piece:
            encoding = encoding_of(piece)
            decoder = None
            if encoding.startswith("utf-16"):
                decoder = codecs.getincrementaldecoder(encoding)("replace")
        begins = not piece
        if decoder is None or not piece:
            yield piece
        elif text := decoder.decode(piece):
            yield text.encode()


def decode_text(content: bytes, words: Sequence[str] = ()) -> str:
    r"""Decode a text that any program may have written: by its mark, UTF-8 where it is, Latin-1 otherwise.

    `words` in Chinese, Japanese or Korean, of which one encoding of these shows the most in the first lines.

    >>> decode_text("時間,指令変位".encode("cp932"), ["時間", "时间"]), decode_text(b"\xb5m", ["時間"])
    ('時間,指令変位', 'µm')
    """
    plain = as_utf8(content)
    try:
        return plain.decode("utf-8")
    except UnicodeDecodeError:
        head = plain[:_HEAD].rpartition(b"\n")[0] or plain
    counts = {encoding: _count_words(head, encoding, words) for encoding in _EAST_ASIAN if words}
    best = max(counts, key=lambda encoding: counts[encoding], default="latin-1")
    return plain.decode(best if counts.get(best) else "latin-1", errors="replace")


def _count_words(head: bytes, encoding: str, words: Sequence[str]) -> int:
    """Count words of a text in an encoding; none where it is not that."""
    try:
        text = head.decode(encoding)
    except UnicodeDecodeError:
        return 0
    return sum(text.count(word) for word in words)


def as_text(argument: str) -> str:
    """Read what the command line's locale could not read, and holds as surrogates, as UTF-8.

    >>> as_text("1±0.01".encode().decode("ascii", "surrogateescape"))
    '1±0.01'
    """
    return argument.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def as_cell(text: str) -> str:
    """Write a text for a cell of a table so that a spreadsheet shows it, and computes nothing.

    Returns the text; behind an apostrophe where it would be a formula and is no number.

    >>> as_cell("=1+1"), as_cell("-0.5"), as_cell("KOBE"), restore_cell(as_cell("=1+1"))
    ("'=1+1", '-0.5', 'KOBE', '=1+1')
    """
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def restore_cell(cell: str) -> str:
    """Read what :func:`as_cell` wrote."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell) else cell


def printable(text: str) -> str:
    r"""Name characters that would steer a terminal, turn the order of a line, or cannot be written.

    >>> print(printable("red \x1b[31m"))
    red \x1b[31m
    """
    return "".join(
        character.encode("unicode_escape").decode() if _steers(character) else character for character in text
    )


def substitute_characters(text: str, stream: IO[str]) -> str:
    """Put what a stream writes for characters that it lacks, so that columns are as wide as they will be."""
    encoding = getattr(stream, "encoding", None) or "utf-8"
    return text.encode(encoding, getattr(stream, "errors", None) or "surrogatepass").decode(
        encoding, "surrogatepass"
    )


def _steers(character: str) -> bool:
    if character in "\n\t":
        return False
    turns = "\u202a" <= character <= "\u202e" or "\u2066" <= character <= "\u2069"
    return turns or unicodedata.category(character) in {"Cc", "Cs", "Zl", "Zp"}
