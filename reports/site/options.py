"""Reference of the commands and their options, from the declarations by which they are parsed.

`{commands}` becomes a table of all commands, `{options}` a table of the options of each.
"""

import re
from collections.abc import Iterator

import click
import typer
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from reliab.app.cli import application


def named_commands() -> Iterator[tuple[str, click.Command]]:
    """Yield each command with its whole name, those of a group after the group."""
    yield from _of_group(typer.main.get_group(application()), "reliab")


def _of_group(group: click.Group, path: str) -> Iterator[tuple[str, click.Command]]:
    for name, command in group.commands.items():
        if hasattr(command, "commands"):  # typer brings a class of groups of its own
            yield from _of_group(command, f"{path} {name}")
        elif not command.hidden:
            yield f"{path} {name}", command


def command_table() -> str:
    """Write a table of all commands as Markdown."""
    rows = [f"| `{name}` | {_first_sentence(command.help)} |" for name, command in named_commands()]
    return "\n".join(["| command | does |", "|---|---|", *rows])


def option_tables() -> str:
    """Write the arguments and options of each command as Markdown."""
    return "\n".join(line for name, command in named_commands() for line in _options(name, command))


def _options(name: str, command: click.Command) -> Iterator[str]:
    yield f"\n## `{name}`\n"
    yield f"{_first_sentence(command.help)}\n"
    yield "| option | value | meaning |"
    yield "|---|---|---|"
    for parameter in command.params:
        if parameter.name != "help":
            metavar = getattr(parameter, "metavar", None) or ""
            text = _mark_options(" ".join((getattr(parameter, "help", None) or "").split()))
            if parameter.default and "default" not in text:
                text = f"{text.removesuffix('.')} (default {str(parameter.default).removesuffix('.0')})."
            is_option = parameter.param_type_name == "option"
            names = ", ".join(f"`{each}`" for each in parameter.opts) if is_option else f"`{metavar}`"
            value = f"`{metavar}`" if is_option and metavar else ""
            yield "| " + " | ".join(_in_cell(cell) for cell in (names, value, text)) + " |"


def _first_sentence(text: str | None) -> str:
    whole = " ".join((text or "").split())
    return re.split(r"(?<=\.) (?=[A-Z`])", whole)[0]


def _mark_options(text: str) -> str:
    """Set the names of options as code, unless they stand in code already."""
    return "`".join(
        part if place % 2 else re.sub(r"(?<![\w-])--[a-z][a-z-]*", r"`\g<0>`", part)
        for place, part in enumerate(text.split("`"))
    )


def _in_cell(text: str) -> str:
    return text.replace("|", "\\|")


class Commands(SphinxDirective):
    """The table of commands; it takes no argument."""

    def run(self) -> list[nodes.Node]:
        """Put the table into the page."""
        return self.parse_text_to_nodes(command_table())


class Options(SphinxDirective):
    """The tables of options; they take no argument."""

    def run(self) -> list[nodes.Node]:
        """Put the tables into the page."""
        return self.parse_text_to_nodes(option_tables(), allow_section_headings=True)


def setup(site: Sphinx) -> dict[str, bool]:
    """Make the directives known to Sphinx."""
    site.add_directive("commands", Commands)
    site.add_directive("options", Options)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
