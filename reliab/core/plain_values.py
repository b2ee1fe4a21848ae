"""Results as plain values for JSON: each states once which of its values it writes, and under which keys."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from reliab.core.stated_value import StatedValue

if TYPE_CHECKING:
    import pandas as pd

AS_SHOWN: Final[Mapping[str, Any]] = {"max_rows": 20, "float_format": "{:.4g}".format}
"""How pandas writes a table in a summary and in a notebook."""


class PlainResult:
    """A dataclass that writes its fields, or the values that `keys` names, as plain values.

    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Peak(PlainResult):
    ...     keys = {"time_s": "time", "peaks": "values"}
    ...     time: float
    ...     values: tuple[float, ...]
    >>> Peak(0.5, (1.0, 2.0)).to_dict()
    {'time_s': 0.5, 'peaks': [1.0, 2.0]}
    """

    # Attribute of each key, with dots through attributes and keys; every field under its own name by default.
    # A key carries the unit: `time_s`, `delay_ms`.
    keys: ClassVar[Mapping[str, str]] = {}

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys."""
        if not self.keys:
            return _fields(self)
        return {key: plain_value(reduce(_part, name.split("."), self)) for key, name in self.keys.items()}

    def to_dataframe(self) -> "pd.DataFrame":
        """Put the values into a table of one row; a value within a value is `outer_inner`."""
        import pandas as pd

        return pd.json_normalize(self.to_dict(), sep="_")

    def summary(self) -> str:
        """Say the answer as plain text: a line for each value, or a table of the first rows."""
        table = self.to_dataframe()
        if len(table) != 1:
            return str(table.to_string(index=False, **AS_SHOWN))
        values = {name: value for name, value in table.iloc[0].items() if not isinstance(value, list)}
        return "\n".join(f"{name}: {_as_text(value)}" for name, value in values.items())

    def _repr_html_(self) -> str:
        """Table for notebooks."""
        table = self.to_dataframe()
        shown = table.T if len(table) == 1 else table
        return str(shown.to_html(na_rep="", **AS_SHOWN))


def _part(whole: Any, name: str) -> Any:  # noqa: ANN401 - of any result
    return whole[name] if isinstance(whole, Mapping) else getattr(whole, name)


def _fields(dataclass: Any) -> dict[str, Any]:  # noqa: ANN401 - any dataclass
    return {field.name: plain_value(getattr(dataclass, field.name)) for field in fields(dataclass)}


def _as_text(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def plain_value(value: Any) -> Any:  # noqa: ANN401 - of any result
    """Turn a value into what JSON holds; a stated value has its standard deviation beside it."""
    plain = value
    match value:
        case StatedValue():
            plain = {"value": value.value, "sd": value.deviation}
        case _ if hasattr(value, "to_dict"):
            plain = value.to_dict()
        case _ if is_dataclass(value):
            plain = _fields(value)
        case Mapping():
            plain = {str(key): plain_value(item) for key, item in value.items()}
        case list() | tuple():
            plain = [plain_value(item) for item in value]
        case np.ndarray() | np.generic():
            plain = value.tolist()
        case str() | Path():
            plain = str(value)
    return plain
