"""Results as plain values, tables of pandas, and HTML; tables are written so that no cell is a formula."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import reduce
from html import escape
from inspect import ismethod
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final, TypeAlias

import numpy as np

from reliab.core.columns import Columns, write_cells
from reliab.core.encodings import as_cell, restore_cell
from reliab.core.files import refuse_unwritable, written_whole
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


TABLE_FORMAT: Final[Mapping[str, Any]] = {"max_rows": 20, "float_format": "{:.4g}".format}
"""How pandas writes a table in a summary and in a notebook."""


Keys: TypeAlias = Mapping[str, "str | Keys | tuple[str, Keys]"]
"""Keys of a result with the source of each; see :class:`PlainResult`."""


def same_names(*names: str) -> dict[str, str]:
    """Give attributes their own names as keys."""
    return dict(zip(names, names, strict=True))


class PlainResult:
    """A dataclass that writes its fields, or what `keys` names, as plain values.

    The source of a key is an attribute or method, with dots through attributes and keys, or keys that stand
    together under it: those of the result, or as `(attribute, keys)` those of a part or of each of several.
    Keys that stand together are None if the source of their "?" is missing.
    The step `0` of a source is the first of several parts, `[name]` takes the attribute `name` of each, and
    `{name}` puts them into a mapping by it.

    A key states its unit, and one in `ms` is written in milliseconds if its attribute is in seconds. A key
    that ends in "?" is left out if there is nothing to write, and "**" adds the keys of a part to those of
    the result. What is missing, infinite or no number is None.

    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Peak(PlainResult):
    ...     keys = {"time_ms": "time", "peaks": "values", "at": {"floor?": "floor"}}
    ...     time: float
    ...     values: tuple[float, ...]
    ...     floor: str = ""
    >>> Peak(0.5, (1.0, float("inf"))).to_dict()
    {'time_ms': 500.0, 'peaks': [1.0, None], 'at': {}}
    """

    keys: ClassVar[Keys] = {}  # Every field under its own name by default

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys."""
        return _write_keys(self, self.keys) if self.keys else _fields(self)

    def to_dataframe(self) -> "pd.DataFrame":
        """Put the values into a table of one row; a value within a value is `outer_inner`."""
        import pandas as pd

        return pd.json_normalize(self.to_dict(), sep="_")

    def summary(self) -> str:
        """Say the answer as plain text: a line for each value, or a table of the first rows."""
        table = self.to_dataframe()
        if len(table) != 1:
            return str(table.to_string(index=False, **TABLE_FORMAT))
        values = {name: value for name, value in table.iloc[0].items() if not isinstance(value, list)}
        texts = {
            name: f"{value:.4g}" if isinstance(value, float) else value for name, value in values.items()
        }
        return "\n".join(f"{name}: {text}" for name, text in texts.items())

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the numbers as points in a row each, and return the axes.

        `axes`: those to draw into; new ones by default.
        """
        from matplotlib import pyplot as plt

        plot_axes = axes if axes is not None else plt.figure(layout="constrained").gca()
        numbers = self.to_dataframe().select_dtypes("number").iloc[0]
        plot_axes.plot(numbers.to_numpy(), numbers.index.to_numpy(), "o")
        plot_axes.set_xscale("symlog")
        plot_axes.invert_yaxis()
        return plot_axes

    def _repr_html_(self) -> str:
        """Table for notebooks."""
        table = self.to_dataframe()
        rows = table.T if len(table) == 1 else table
        return str(rows.to_html(na_rep="", **TABLE_FORMAT))


def _write_keys(result: Any, keys: Keys) -> dict[str, Any]:  # noqa: ANN401 - any result
    content: dict[str, Any] = {}
    for key, source in keys.items():
        value = _write_source(result, source)
        if isinstance(source, str) and _in_milliseconds(key) and not _in_milliseconds(source):
            value = _multiply(value, MILLI)
        if key.startswith("**"):
            content |= value
        elif not key.endswith("?"):
            content[key] = value
        elif value is not None and value not in ("", [], {}):
            content[key[:-1]] = value
    return content


def _write_source(result: Any, source: str | Keys | tuple[str, Keys]) -> Any:  # noqa: ANN401 - of any result
    match source:
        case str():
            return plain_value(_follow(result, source))
        case (str() as path, keys):
            part = _follow(result, path)
            if isinstance(part, list | tuple):
                return [_write_keys(item, keys) for item in part]
            if isinstance(part, Mapping):
                return {name: _write_keys(item, keys) for name, item in part.items()}
            return None if part is None else _write_keys(part, keys)
        case _:
            inner = dict(source)
            is_missing = "?" in inner and _write_source(result, inner.pop("?")) is None
            return None if is_missing else _write_keys(result, inner)


def _follow(result: Any, path: str) -> Any:  # noqa: ANN401 - of any result
    return reduce(_part, path.split("."), result)


def _part(container: Any, name: str) -> Any:  # noqa: ANN401 - of any result
    if container is None:
        return None
    if name.isdecimal():
        return container[int(name)]
    if name.startswith("{"):
        return {_part(item, name[1:-1]): item for item in container}
    if name.startswith("["):
        return [_part(item, name[1:-1]) for item in container]
    if isinstance(container, Mapping):
        return container[name]
    attribute = getattr(container, name)
    return attribute() if ismethod(attribute) else attribute


def _in_milliseconds(name: str) -> bool:
    return "ms" in re.split(r"[_.?]", name)


def _multiply(value: Any, factor: float) -> Any:  # noqa: ANN401 - numbers in lists
    if isinstance(value, list):
        return [_multiply(item, factor) for item in value]
    return None if value is None else factor * value


def _fields(dataclass: Any) -> dict[str, Any]:  # noqa: ANN401 - any dataclass
    return {field.name: plain_value(getattr(dataclass, field.name)) for field in fields(dataclass)}


def finite(value: float | None) -> float | None:
    """Return a number ready for JSON; None where it is unknown or infinite."""
    return float(value) if value is not None and np.isfinite(value) else None


def plain_value(value: Any) -> Any:  # noqa: ANN401 - of any result
    """Turn a value into what JSON holds; a stated value has its standard deviation beside it."""
    plain = value
    match value:
        case float():
            plain = finite(value)
        case StatedValue():
            plain = {"value": value.value, "sd": value.deviation}
        case _ if hasattr(value, "to_dict"):
            plain = value.to_dict()
        case _ if is_dataclass(value):
            plain = _fields(value)
        case Mapping():
            plain = {str(key): plain_value(item) for key, item in value.items()}
        case list() | tuple() | Iterator():
            plain = [plain_value(item) for item in value]
        case np.ndarray() | np.generic():
            plain = plain_value(value.tolist())
        case str() | Path():
            plain = str(value)
    return plain


class ResultWithRows(PlainResult):
    """A result whose plain values hold rows: criteria, tests, motions, ellipses."""

    rows_in: ClassVar[str]  # The key of `to_dict` that holds the rows
    # Columns on a screen, in `summary` and in notebooks, or names of those of the table; all by default
    table_columns: ClassVar[Columns | tuple[str, ...]] = ()
    plot_columns: ClassVar[tuple[str, str]] = (
        "",
        "",
    )  # Columns that `plot` draws; row, first number by default

    def plain_rows(self) -> list[dict[str, Any]]:
        """Give the rows as plain values."""
        rows: list[dict[str, Any]] = self.to_dict()[self.rows_in]
        return rows

    def to_dataframe(self) -> "pd.DataFrame":
        """Put the rows into a table, with their keys as columns; a value within a value is `outer_inner`."""
        import pandas as pd

        return pd.json_normalize(self.plain_rows(), sep="_")

    def summary(self) -> str:
        """Say the answer as plain text: a table of the first rows."""
        return str(self._select_columns().to_string(index=False, **TABLE_FORMAT))

    def _repr_html_(self) -> str:
        """Table for notebooks."""
        return str(self._select_columns().to_html(index=False, na_rep="", **TABLE_FORMAT))

    def _select_columns(self) -> "pd.DataFrame":
        if isinstance(self.table_columns, Mapping):
            import pandas as pd

            cells = write_cells(self.table_columns, self.plain_rows())
            return pd.DataFrame(cells, columns=list(self.table_columns))
        table = self.to_dataframe()
        return table[list(self.table_columns)] if self.table_columns and len(table) else table

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the rows as points, and return the axes.

        `axes`: those to draw into; new ones by default.
        """
        from matplotlib import pyplot as plt

        plot_axes = axes if axes is not None else plt.figure(layout="constrained").gca()
        table = self.to_dataframe()
        x_column, y_column = self.plot_columns
        y_column = y_column or [*table.select_dtypes("number").columns, *table.columns][0]
        plot_axes.plot(table[x_column] if x_column else table.index, table[y_column], "o")
        plot_axes.set(xlabel=x_column or "row", ylabel=y_column)
        return plot_axes


def plot_histories(
    histories: Mapping[str, np.ndarray],
    time_step: float,
    *,
    title: str,
    label: str = "",
    axes: "Axes | None" = None,
) -> "Axes":
    """Draw histories over time [s] by their names, into new axes by default; `label`: what they are."""
    from matplotlib import pyplot as plt

    plot_axes = plt.subplots(figsize=(8.0, 3.0), layout="constrained")[1] if axes is None else axes
    for name, values in histories.items():
        plot_axes.plot(np.arange(values.size) * time_step, values, linewidth=0.8, label=name)
    plot_axes.set(xlabel="time [s]", ylabel=label, title=title)
    plot_axes.legend(frameon=False)
    return plot_axes


def write_table(table: "pd.DataFrame", path: str | Path, *, index: bool = False) -> None:
    """Write a table as CSV, whole or not at all; texts that a spreadsheet would compute stay texts."""
    safe_table = _map_texts(table, as_cell)
    with refuse_unwritable("Cannot write the table's file", where=path), written_whole(path) as file:
        safe_table.to_csv(file, index=index, errors="backslashreplace")


def read_table(path: str | Path) -> "pd.DataFrame":
    """Read what :func:`write_table` wrote."""
    import pandas as pd

    return _map_texts(pd.read_csv(path), restore_cell)


def _map_texts(table: "pd.DataFrame", change: Callable[[str], str]) -> "pd.DataFrame":
    """Change the texts of a table, in its cells and in the names of its columns."""
    texts = table.select_dtypes(exclude=["number", "bool"])
    new_texts = texts.map(lambda cell: change(cell) if isinstance(cell, str) else cell)
    return table.assign(**new_texts).rename(columns=lambda name: change(str(name)))


def html_table(title: str, rows: Mapping[str, str], notes: Iterable[str] = ()) -> str:
    """Write a table of names and values.

    >>> html_table("Test <1>", {"A": "0.997"})
    '<table><caption>Test &lt;1&gt;</caption><tr><th scope="row">A</th><td>0.997</td></tr></table>'
    """
    lines = "".join(
        f'<tr><th scope="row">{escape(name)}</th><td>{escape(value)}</td></tr>'
        for name, value in rows.items()
    )
    paragraphs = "".join(f"<p>{escape(note)}</p>" for note in notes)
    return f"<table><caption>{escape(title)}</caption>{lines}</table>{paragraphs}"
