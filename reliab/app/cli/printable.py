"""Names as they may be shown on a terminal."""

import unicodedata
from typing import IO


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
