"""Messages name the arguments of Python in backquotes; the command line writes them as its options."""

import re
from collections.abc import Iterator
from typing import Any

_ARGUMENT = re.compile(r"`([a-z]\w*)(?:=([^`]+))?`")


def as_options(message: str, command: Any) -> str:  # noqa: ANN401 - Typer hides its type
    """Write the arguments that a message names as options of the command line.

    `` `time_units="ms"` `` as ``--time-units ms``; what names no option stays as it is.

    >>> import typer
    >>> from reliab.cli import app
    >>> command = typer.main.get_command(app)
    >>> as_options('Give `xi` or `time_units="ms"`, as `reliab info` says of `this`', command)
    'Give --xi or --time-units ms, as `reliab info` says of `this`'
    """
    flags = dict(_flags(command))

    def option(argument: re.Match[str]) -> str:
        name, value = argument.groups()
        if name not in flags:
            return argument.group()
        return flags[name] if value is None else f"{flags[name]} {value.strip(chr(34))}"

    return _ARGUMENT.sub(option, message)


def _flags(command: Any) -> Iterator[tuple[str, str]]:  # noqa: ANN401
    """Options of all commands by their names in Python; one name means one thing everywhere."""
    for parameter in command.params:
        if parameter.opts[0].startswith("--"):
            yield parameter.name, parameter.opts[0]
    for subcommand in getattr(command, "commands", {}).values():
        yield from _flags(subcommand)
