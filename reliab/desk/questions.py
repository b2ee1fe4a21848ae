"""What a form asks, as arguments of the Python interface, as its line and as a command."""

import json
import shlex
from collections.abc import Iterable, Mapping
from typing import Any, Final

from reliab.core.errors import InputError

_PARTS: Final = ("command", "measured", "time", "force", "ground")
_NUMBERS: Final = ("threshold", "wait")  # arguments without a standard deviation


def select_filled(values: Mapping[str, Any], names: Iterable[str]) -> dict[str, Any]:
    """Take the arguments of these names that are filled in; those that are plain numbers as such.

    >>> select_filled({"f": " 1±0.01 ", "xi": "", "threshold": "0,05"}, ("f", "xi", "threshold"))
    {'f': '1±0.01', 'threshold': 0.05}
    """
    entries = {name: values.get(name) for name in names}
    texts = {name: value.strip() if isinstance(value, str) else value for name, value in entries.items()}
    return {
        name: number(value, name) if name in _NUMBERS else value
        for name, value in texts.items()
        if value not in ("", None)
    }


def number(text: str, name: str) -> float:
    """Read a number of a form."""
    try:
        return float(text.replace(",", "."))
    except ValueError:
        raise InputError(
            f"The value of `{name}` must be a number", value=repr(text), remedy="Correct it"
        ) from None


def command_line(command: str, files: Iterable[str], arguments: Mapping[str, Any]) -> str:
    """Write a question as the command that asks it.

    >>> command_line("assess", ["my test.csv"], {"f": "1±0.01", "test_name": "run 2"})
    "reliab assess 'my test.csv' --f '1±0.01' --test 'run 2'"
    """
    options = [
        text
        for name, value in arguments.items()
        for text in (
            f"--{_OPTIONS.get(name, name.replace('_', '-'))}",
            *(() if value is True else (str(value),)),
        )
    ]
    return shlex.join(["reliab", *command.split(), *map(_as_file, files), *options])


_OPTIONS: Final = {"test_name": "test"}


def _as_file(name: str) -> str:
    """Keep a name that begins with a dash from being taken for an option."""
    return f"./{name}" if name.startswith("-") else name


def python_line(function: str, files: Iterable[str], arguments: Mapping[str, Any]) -> str:
    """Write a question as a line of Python.

    >>> python_line("assess", ["test.csv"], {"f": "1±0.01", "threshold": 0.05})
    "reliab.assess('test.csv', f='1±0.01', threshold=0.05)"
    """
    names = list(files)
    first = repr(names[0]) if len(names) == 1 else repr(names)
    return f"reliab.{function}({', '.join([first, *(f'{n}={v!r}' for n, v in arguments.items())])})"


def channels_toml(corrections: Mapping[str, Mapping[str, Any]], rate: float | None = None) -> str:
    """Write corrections of channels as the file `channels.toml`; empty where nothing is corrected.

    >>> print(channels_toml({"measured": {"column": "LVDT", "unit": "mm", "sign": -1}}, 256.0))
    [channels.measured]
    column = "LVDT"
    unit = "mm"
    sign = -1
    <BLANKLINE>
    [sampling]
    rate_hz = 256.0
    <BLANKLINE>
    """
    tables = [
        "\n".join(
            [f"[channels.{channel}]", *(f"{name} = {_toml(value)}" for name, value in table.items()), ""]
        )
        for channel, table in corrections.items()
        if channel in _PARTS and table
    ]
    return "\n".join([*tables, *([f"[sampling]\nrate_hz = {rate!r}\n"] if rate else [])])


def _toml(value: str | int) -> str:
    """Write a value as TOML does; its texts are those of JSON but for one letter."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
