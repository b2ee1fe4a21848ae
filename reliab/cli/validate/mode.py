"""Ways of judging that `reliab validate` has, each with its own options."""

from dataclasses import fields
from typing import TypeVar

import typer

from reliab.cli.options import given_options, options_of
from reliab.errors import InputError

Mode = TypeVar("Mode")
_BELONG_TO = {"integrator": "--case", "compensator": "--case", "tests": "--rebuilt-error"}


def alone(option: str, mode: type[Mode], context: typer.Context) -> Mode:
    """Take the options of a way of judging, and refuse those that it would not use."""
    used = {*(field.name for field in fields(mode)), option.removeprefix("--").replace("-", "_")}  # type: ignore[arg-type]
    for name in given_options(context):
        if name not in used:
            spelled = f"--{name.replace('_', '-')}"
            where = f"beside {option}" if option else f"without {_BELONG_TO[name]}"
            raise InputError(f"{spelled} has no effect {where}", remedy="Leave it out")
    return mode(**options_of(mode, context))
