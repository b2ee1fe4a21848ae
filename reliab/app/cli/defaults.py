"""A laboratory's own defaults: options of the commands that a file states.

The file is `reliab.toml` in the user's configuration folder, the one that the environment variable
RELIAB_CONFIG names, or the one that `--config` names. No file of the folder where a command runs is read
unless it is named: such a folder may come from somebody else. A table for each command holds options by their
names without the dashes ::

    [assess]
    f = "1±0.01"
    xi = 0.02

What the command line says comes first, then the file, then what the header of a test states. What is written,
and what a test is judged by, is stated on the command line only.
"""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import typer

from reliab.app.cli.commands import OUTPUT_OPTIONS
from reliab.core.described_files import read_toml
from reliab.core.errors import InputError

FILE: Final = "reliab.toml"
"""Name of the file in the user's configuration folder."""

VARIABLE: Final = "RELIAB_CONFIG"
"""Environment variable that names another file."""

OPTION: Final = "--config"
"""Option of the program that names another file; it may stand anywhere on the command line."""

COMMAND_LINE_ONLY: Final = frozenset(
    (
        *OUTPUT_OPTIONS,
        *("figures", "chains", "export", "tests"),  # written, too
        *("check", "threshold", "confidence", "metric", "criterion", "exact"),  # what judges a test
    )
)
"""Options that no file of defaults may state."""


@dataclass(frozen=True, kw_only=True)
class Defaults:
    """Defaults of commands."""

    path: Path | None = None  # Their file; None where there is none
    values: dict[str, dict[str, Any]] = field(default_factory=dict)  # By command and name of the parameter

    def sentences(self, arguments: Sequence[str]) -> Iterator[str]:
        """Name the file from which a command line takes defaults, and one of this folder that is not read."""
        if arguments and self.values.get(arguments[0]):
            yield f"Defaults of {arguments[0]} from {self.path}."
        if self.path is None and Path(FILE).is_file():
            yield f"{FILE} of this folder is not read. If it is yours, name it: {OPTION} {FILE}."


def user_file() -> Path:
    """Place of the file in the user's configuration folder."""
    return Path(typer.get_app_dir("reliab")) / FILE


def remove_config(arguments: Sequence[str]) -> tuple[list[str], str | None]:
    """Take the option that names the file of defaults from a command line; return its value too.

    >>> remove_config(["assess", "--config", "lab.toml", "test.csv"])
    (['assess', 'test.csv'], 'lab.toml')
    """
    remaining, config = [], None
    iterator = iter(arguments)
    for argument in iterator:
        name, equals, value = argument.partition("=")
        if name != OPTION:
            remaining.append(argument)
            continue
        config = value if equals else next(iterator, "")
        if not config:
            raise InputError(f"{OPTION} needs a file", remedy="Name it")
    return remaining, config


def read_defaults(commands: Callable[[], Any], config: str | None = None) -> Defaults:
    """Read a laboratory's defaults, which may be of any of the commands that are made where there are some.

    `named`: the file that the command line names; by default that of the environment or of the user's folder.
    """
    config_path = config or os.environ.get(VARIABLE)
    path = Path(config_path) if config_path else user_file()
    if not config_path and not path.is_file():
        return Defaults()
    content = read_toml(
        path,
        rule="The file of defaults must be readable TOML",
        remedy="Correct it, or name another" if config else f"Correct it, or name another with {OPTION}",
    )
    group = commands()
    return Defaults(
        path=path,
        values={name: _defaults_of_command(name, table, group, path) for name, table in content.items()},
    )


def _defaults_of_command(name: str, table: object, group: Any, path: Path) -> dict[str, Any]:  # noqa: ANN401
    """Values of one command by the names of its parameters."""
    commands = {key: item for key, item in group.commands.items() if not hasattr(item, "commands")}
    if name not in commands or not isinstance(table, dict):
        raise InputError(
            "Not a table of a command",
            value=f"[{name}]" if isinstance(table, dict) else name,
            remedy=f"Choose among {', '.join(sorted(commands))}",
            where=str(path),
        )
    options = {
        flag.lstrip("-"): option
        for option in commands[name].params
        for flag in option.opts
        if flag.startswith("--") and flag != "--help"
    }
    allowed_names = sorted(key for key, option in options.items() if option.name not in COMMAND_LINE_ONLY)
    for key in table:
        if key in options and key not in allowed_names:
            raise InputError(
                "Outputs, and what decides a verdict, cannot be defaults",
                value=f"{key} of [{name}]",
                remedy=f"Remove it from the file, and give --{key} on the command line",
                where=str(path),
            )
        if key not in options:
            raise InputError(
                f"{name} has no such option",
                value=key,
                remedy=f"Choose among {', '.join(allowed_names)}",
                where=str(path),
            )
    return {str(options[key].name): _as_stated(value, options[key], path) for key, value in table.items()}


def _as_stated(value: object, option: Any, path: Path) -> object:  # noqa: ANN401 - Click's parameter
    """Give an option that may be repeated its list; take a file from the folder of the file of defaults."""
    if option.type_descriptor.annotation is Path and isinstance(value, str) and Path(value).suffix:
        value = str(path.parent / value)  # what has no ending is a name that ships
    return [value] if option.multiple and not isinstance(value, list) else value
