"""Commands and code as texts of the project tell their readers to type them."""

import re
import shlex

import typer

from reliab.app.cli import application, spread

INSTALL = "python -m pip install"  # what the test's own environment has already


def blocks(text, kind):
    """Return what stands in the fenced blocks of a kind."""
    return re.findall(rf"```{re.escape(kind)}\n(.*?)```", text, flags=re.DOTALL)


def command_blocks(text):
    """Return the lines of each block that is to be typed into a terminal."""
    lines = [[line.removeprefix("$ ") for line in block.splitlines()] for block in blocks(text, "console")]
    return [[line for line in block if not line.startswith(INSTALL)] for block in lines]


def reliab_lines(text):
    """Return the commands of the package in a text, each once, in their order."""
    lines = [line for block in command_blocks(text) for line in block]
    return list(dict.fromkeys(line for line in lines if line.startswith("reliab ")))


def parameters(line):
    """Return what a command is told; fails where an option does not exist or does not take its value."""
    group = typer.main.get_group(application())
    name, *arguments = spread(shlex.split(line)[1:], group)
    command = group.commands[name]
    while hasattr(command, "commands"):
        name, *arguments = arguments
        command = command.commands[name]
    return command.make_context(name, arguments).params
