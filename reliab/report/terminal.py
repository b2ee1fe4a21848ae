"""A document on the terminal: its text and tables, without its figures."""

import re
from collections.abc import Iterable
from typing import Final

from rich import box
from rich.console import Console
from rich.table import Table as RichTable

from reliab.report.document import Block, Document, Equation, Points, Remark, Section, Table
from reliab.report.numbers import MISSING, cells, write_in_line
from reliab.report.prose import formula, words_of

_NUMBER: Final = re.compile(r"[-+−]?\d[\d.,]*(?: %)?")
_NO_NUMBER: Final = ("", MISSING, "unknown", "none")


def print_document(document: Document, console: Console) -> None:
    """Print what was asked, every block and the sources; the verdict stands above, as its caller words it."""
    for name, text in document.facts.items():
        if text:
            console.print(f"{name}: {words_of(text)}", highlight=False)
    print_blocks(document.blocks, console)
    references = document.list_references()
    for source in document.sources:
        if source.label in references:
            console.print(f"[{source.label}] {source.text}", highlight=False)


def print_blocks(blocks: Iterable[Block], console: Console) -> None:
    """Print blocks one below the other."""
    after_table = False
    for block in blocks:
        if after_table and not isinstance(block, Section):
            console.print()
        after_table = isinstance(block, Table)
        match block:
            case Section():
                console.print()
                console.print(block.title, style="bold", highlight=False)
                print_blocks(block.blocks, console)
            case str() | tuple() | Remark():
                text = block.text if isinstance(block, Remark) else block
                console.print(words_of(text), highlight=False)
            case Points():
                for item in block.items:
                    console.print(f"- {words_of(item)}", highlight=False)
            case Equation():
                console.print(formula(block.math), highlight=False)
            case Table():
                if caption := words_of(block.caption):
                    console.print(caption, style="italic", highlight=False)
                console.print(rich_table(block))


def rich_table(table: Table) -> RichTable:
    """Make the table that Rich prints; texts are folded where the terminal is narrow, numbers never."""
    table_shown = RichTable(box=box.SIMPLE, padding=(0, 1, 0, 0), show_edge=False)
    columns = []
    for column in table.columns:
        texts = [
            cell if isinstance(cell, str) else write_in_line(cell[0])
            for cell in cells(list(table.frame[column.key]), column.number)
        ]
        columns.append(texts)
        numbers = [text for text in texts if text not in _NO_NUMBER]
        are_numbers = bool(numbers) and all(map(_NUMBER.fullmatch, numbers))
        right = column.right or column.number is not None or are_numbers
        heading = ", ".join(filter(None, map(words_of, (column.group, column.heading))))
        heading += f" [{column.unit}]" if column.unit else ""
        table_shown.add_column(heading, justify="right" if right else "left", no_wrap=right, overflow="fold")
    for row in zip(*columns, strict=True):
        table_shown.add_row(*row)
    return table_shown
