"""A terminal on which names are data."""

from typing import Any

from rich.console import Console
from rich.text import Text

from reliab.cli.printable import printable


class LiteralConsole(Console):
    """A console that shows texts as they are: brackets are no markup, and control characters are named."""

    def render_str(self, text: str, **options: Any) -> Text:  # noqa: ANN401 - Rich's options of many types
        """Turn a text into one that Rich sets, letter by letter."""
        return super().render_str(printable(text), **{**options, "markup": False, "emoji": False})
