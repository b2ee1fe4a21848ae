"""A small table in HTML: how results show themselves in a notebook."""

from collections.abc import Iterable, Mapping
from html import escape


def html_table(title: str, rows: Mapping[str, str], notes: Iterable[str] = ()) -> str:
    """Write a table of names and values.

    >>> html_table("Test <1>", {"A": "0.997"})
    '<table><caption>Test &lt;1&gt;</caption><tr><th scope="row">A</th><td>0.997</td></tr></table>'
    """
    lines = "".join(
        f'<tr><th scope="row">{escape(name)}</th><td>{escape(value)}</td></tr>'
        for name, value in rows.items()
    )
    below = "".join(f"<p>{escape(note)}</p>" for note in notes)
    return f"<table><caption>{escape(title)}</caption>{lines}</table>{below}"
