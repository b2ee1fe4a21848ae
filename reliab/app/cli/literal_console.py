"""A console on which names are data and tables in a pipe are whole."""

from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from reliab.core.encodings import printable, substitute_characters

_WIDEST_TABLE = 100_000


class LiteralConsole(Console):
    """A console that shows texts as they are: brackets are no markup, and control characters are named."""

    def render_str(self, text: str, **options: Any) -> Text:  # noqa: ANN401 - Rich's options of many types
        """Turn a text into one that Rich sets, letter by letter."""
        literal = substitute_characters(printable(text), self.file)
        return super().render_str(literal, **{**options, "markup": False, "emoji": False})

    def print(self, *objects: Any, **options: Any) -> None:  # noqa: ANN401 - whatever Rich prints
        """Print; in a pipe a table is as wide as it needs."""
        usual = self.width
        if not self.is_terminal:
            room = self.options.update(width=_WIDEST_TABLE)
            tables = (table for table in objects if isinstance(table, Table))
            self.width = max([usual, *(self.measure(table, options=room).maximum for table in tables)])
        try:
            super().print(*objects, **options)
        finally:
            self.width = usual
