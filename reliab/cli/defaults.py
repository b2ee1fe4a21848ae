"""A laboratory's own defaults: options of the commands that a file states.

The file is `reliab.toml` in the folder where the command runs, or the one that the environment variable
RELIAB_CONFIG names. A table for each command holds options by their names without the dashes ::

    [assess]
    f = "1±0.01"
    xi = 0.02
    threshold = 0.03

What the command line says comes first, then the file, then what the header of a test states.
"""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from reliab.described_files import read_toml
from reliab.errors import InputError

FILE = "reliab.toml"
"""Name of the file in the folder where a command runs."""

VARIABLE = "RELIAB_CONFIG"
"""Environment variable that names another file."""


def read_defaults(commands: Callable[[], Any]) -> dict[str, dict[str, Any]]:
    """Read a laboratory's defaults, which may be of any of the commands that are made where there are some.

    By command, values by the names of its parameters; empty where there is no file.
    """
    named = os.environ.get(VARIABLE)
    path = Path(named or FILE)
    if not named and not path.is_file():
        return {}
    content = read_toml(
        path,
        rule="The file of defaults must be readable TOML",
        remedy=f"Correct it, or unset {VARIABLE}" if named else "Correct it, or rename it",
    )
    group = commands()
    return {name: _of_command(name, table, group, path) for name, table in content.items()}


def _of_command(name: str, table: object, group: Any, path: Path) -> dict[str, Any]:  # noqa: ANN401
    """Values of one command by the names of its parameters."""
    commands = {key: item for key, item in group.commands.items() if not hasattr(item, "commands")}
    if name not in commands or not isinstance(table, dict):
        raise InputError(
            "A file of defaults has a table for each command",
            value=f"[{name}]" if isinstance(table, dict) else name,
            remedy=f"Choose among {', '.join(sorted(commands))}",
            where=str(path),
        )
    options = {
        flag.lstrip("-"): option
        for option in commands[name].params
        for flag in option.opts
        if flag.startswith("--")
    }
    unknown = [key for key in table if key not in options or key == "help"]
    if unknown:
        raise InputError(
            f"Defaults of {name} are its options, without the dashes",
            value=unknown[0],
            remedy=f"Choose among {', '.join(sorted(options))}",
            where=str(path),
        )
    return {str(options[key].name): _listed(value, options[key]) for key, value in table.items()}


def _listed(value: object, option: Any) -> object:  # noqa: ANN401 - Click's parameter
    """Give an option that may be repeated its list, and every other one its value."""
    return [value] if option.multiple and not isinstance(value, list) else value
