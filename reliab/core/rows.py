"""Results that hold rows give them as a table of pandas; tables are written so that no cell is a formula."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from reliab.core.encodings import as_cell, of_cell
from reliab.core.files import refuse_unwritable, written_whole
from reliab.core.plain_values import AS_SHOWN, PlainResult

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


class ResultWithRows(PlainResult):
    """A result whose plain values hold rows: criteria, tests, motions, ellipses."""

    rows_in: ClassVar[str]  # The key of `to_dict` that holds the rows
    shown: ClassVar[tuple[str, ...]] = ()  # Columns in `summary` and in notebooks; all by default
    plotted: ClassVar[tuple[str, str]] = (
        "",
        "",
    )  # Columns that `plot` draws; row and first number by default

    def to_dataframe(self) -> "pd.DataFrame":
        """Put the rows into a table, with their keys as columns; a value within a value is `outer_inner`."""
        import pandas as pd

        return pd.json_normalize(self.to_dict()[self.rows_in], sep="_")

    def summary(self) -> str:
        """Say the answer as plain text: a table of the first rows."""
        return str(self._shown().to_string(index=False, **AS_SHOWN))

    def _repr_html_(self) -> str:
        """Table for notebooks."""
        return str(self._shown().to_html(index=False, na_rep="", **AS_SHOWN))

    def _shown(self) -> "pd.DataFrame":
        table = self.to_dataframe()
        return table[list(self.shown)] if self.shown and len(table) else table

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the rows as points, and return the axes.

        `axes`: those to draw into; new ones by default.
        """
        from matplotlib import pyplot as plt

        drawn = axes if axes is not None else plt.figure().gca()
        table = self.to_dataframe()
        across, up = self.plotted
        numbers = table.select_dtypes("number").columns
        drawn.plot(table[across] if across else table.index, table[up or numbers[0]], "o")
        drawn.set(xlabel=across or "row", ylabel=up or numbers[0])
        return drawn


def write_table(table: "pd.DataFrame", path: str | Path, *, index: bool = False) -> None:
    """Write a table as CSV, whole or not at all; texts that a spreadsheet would compute stay texts."""
    escaped = _with_texts(table, as_cell)
    with refuse_unwritable("Cannot write the table's file", where=path), written_whole(path) as file:
        escaped.to_csv(file, index=index, errors="backslashreplace")


def read_table(path: str | Path) -> "pd.DataFrame":
    """Read what :func:`write_table` wrote."""
    import pandas as pd

    return _with_texts(pd.read_csv(path), of_cell)


def _with_texts(table: "pd.DataFrame", change: Callable[[str], str]) -> "pd.DataFrame":
    """Change the texts of a table, in its cells and in the names of its columns."""
    texts = table.select_dtypes(exclude=["number", "bool"])
    changed = texts.map(lambda cell: change(cell) if isinstance(cell, str) else cell)
    return table.assign(**changed).rename(columns=lambda name: change(str(name)))
