"""The command line `reliab`: one file for each command, or for those of one subject.

Only the command that is asked is imported, and at its top only Typer; numerics, and Rich for tables and bars,
are imported when it needs them, so that it answers at once.
"""

import logging
import os
import sys
import warnings
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from importlib import import_module
from typing import Annotated, Any, Final

import typer

from reliab.app.cli.commands import Command, Group, as_options
from reliab.app.cli.defaults import read_defaults, remove_config
from reliab.app.cli.interruption import interruption, notice_interruption
from reliab.app.cli.output import replace_unwritable_characters
from reliab.app.cli.printable import printable, substitute_characters
from reliab.app.declaration import UNITS, remove_units
from reliab.core.errors import INTERRUPTED, IncompleteError, InputError
from reliab.core.stated_value import StatedValue
from reliab.core.threads import ONE_THREAD
from reliab.version import __version__

_BAD_INPUT = 2
_HELP = {"--help", "--help-all"}
_INCOMPLETE = 3

_COMMANDS: Final[Mapping[str, Mapping[str, str | None]]] = {
    "Judge a test": {
        "assess": "reliab assess sample_test --f 1±0.01 --xi 0.02",
        "compare": "reliab compare none.csv adaptive.csv --f 1 --xi 0.02 --figure ranking.svg",
        "monitor": "reliab monitor sample_test --f 1 --xi 0.02",
        "extrapolate": "reliab extrapolate run_1.csv run_2.csv --f 1 --xi 0.02",
        "desk": "reliab desk tests",
    },
    "Prepare a test": {
        "design": "reliab design --f 1 2 --xi 0.02 --confidence 0.95",
        "explore": "reliab explore --out criterion.html",
        "record": "reliab record sample_test --out test.nc",
        "calibrate": "reliab calibrate sine.csv --actuator-delay 0 --out channels.toml",
        "rig": None,
    },
    "Understand a disagreement": {"diagnose": "reliab diagnose rig_a --out diagnosis"},
    "Research": {
        "criterion": "reliab criterion --f 1 --xi 0.02 --confidence 0.95",
        "ellipses": "reliab ellipses --motions records --f 1 --xi 0.02 --out ellipses.nc",
        "simulate": "reliab simulate --motions synthetic --f 0.5 1 --xi 0.02 --out results.zarr",
        "validate": "reliab validate --results real_suite --f 1 --xi 0.02 --method dirichlet quantile",
        "motions": None,
        "run": "reliab run --list",
        "report": "reliab report runs/quick",
    },
    "Installation": {
        "samples": "reliab samples datasets",
        "fetch": "reliab fetch datasets/real_suite/results.nc",
        "info": "reliab info --json -",
    },
}
"""Commands by panel of the help, each with its example; without one, a group of commands."""

EXAMPLES: Final = {name: text for commands in _COMMANDS.values() for name, text in commands.items() if text}
_PANEL_OF = {name: panel for panel, commands in _COMMANDS.items() for name in commands}
_MODULES = {
    **dict.fromkeys(("fetch", "samples", "info"), "reliab.app.cli.installation"),
    **dict.fromkeys(("run", "report"), "reliab.app.cli.studies"),
    **dict.fromkeys(("compare", "extrapolate"), "reliab.app.cli.assess"),
    "calibrate": "reliab.app.cli.record",
    "ellipses": "reliab.app.cli.simulate",
    "explore": "reliab.app.cli.design",
    "desk": "reliab.desk.command",
}
"""Modules of commands that share one or stand in a folder; the others have one of their name."""


def _show_version(is_asked: bool) -> None:  # noqa: FBT001 - Typer's callback
    if is_asked:
        typer.echo(__version__)
        raise typer.Exit


def _answer(
    version: Annotated[  # noqa: FBT002 - an option of the command line
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version."),
    ] = False,
    config: Annotated[
        str | None,
        typer.Option(
            metavar="FILE.toml",
            help="A laboratory's defaults, in place of reliab.toml of your configuration folder.",
        ),
    ] = None,
) -> None:
    """Answer whether a real-time hybrid simulation can be trusted."""
    del version, config  # the callback has printed it, and `run` has read it


def application(*names: str) -> typer.Typer:
    """Make the program with some of its commands, which are imported, or with all."""
    app = typer.Typer(name="reliab", cls=Group, no_args_is_help=True, pretty_exceptions_enable=False)
    app.callback(help="Can I trust this real-time hybrid simulation?")(_answer)
    for name in names or _PANEL_OF:
        module = import_module(_MODULES.get(name, f"reliab.app.cli.{name}"))
        if name not in EXAMPLES:
            app.add_typer(module.app, name=name, rich_help_panel=_PANEL_OF[name])
        else:
            declare = app.command(
                name,
                cls=Command,
                rich_help_panel=_PANEL_OF[name],
                epilog=f"Example: {EXAMPLES[name]}",
            )
            declare(getattr(module, name))
    return app


@cache
def _commands(*names: str) -> Any:  # noqa: ANN401 - Typer hides its type
    """Make commands with their options; all by default."""
    return typer.main.get_command(application(*names))


@cache
def _make_group(*names: str) -> Any:  # noqa: ANN401 - Typer hides its type
    """Make commands, all by default; help that Rich shows is escaped once."""
    command = typer.main.get_command(application(*names))
    take_help_literally(command)
    return command


def _find_command(arguments: Sequence[str]) -> Any:  # noqa: ANN401 - Typer hides its type
    """Make the command that is asked, or all if there is none of that name."""
    match arguments:
        case ["--version"]:  # printed without Rich
            return _commands()
        case [name, *options] if options and name in _PANEL_OF:
            return _make_group(name) if _HELP & {*options} else _commands(name)
    return _make_group()


def take_help_literally(command: Any) -> None:  # noqa: ANN401 - Typer hides its type
    """Escape a command's help and that of all below it, once: a unit in brackets is no markup of Rich."""
    from rich.markup import escape

    for documented in (command, *command.params):
        for name in ("help", "epilog"):
            if text := getattr(documented, name, None):
                setattr(documented, name, escape(text))
    for inner in getattr(command, "commands", {}).values():
        take_help_literally(inner)


def main() -> None:
    """Run the command line; bad input ends with one sentence and exit code 2."""
    os.environ.update(ONE_THREAD)
    sys.stdout, sys.stderr = map(replace_unwritable_characters, (sys.stdout, sys.stderr))
    sys.exit(run(sys.argv[1:]))


def run(arguments: Sequence[str]) -> int:
    """Run a command.

    Exit code: 0 done, 1 the answer is "not reliable", 2 bad input, 3 unfinished but safe, 130 interrupted by
    Ctrl-C, 141 nobody reads the output to its end. Every other error passes; the program ends with 70.
    """
    for library in ("asyncio", "matplotlib"):  # errors are told once, as below; fonts are listed elsewhere
        logging.getLogger(library).addHandler(logging.NullHandler())
    try:
        arguments, config = remove_config(arguments)
        command = _find_command(arguments)
        with notice_interruption(), warnings.catch_warnings():
            warnings.showwarning = _show_warning
            defaults = read_defaults(_commands, config)
            for sentence in defaults.sentences(arguments):
                _say(sentence, typer.colors.BRIGHT_BLACK)
            try:
                command.main(
                    list(spread(arguments, command)),
                    prog_name="reliab",
                    default_map=defaults.values,
                    obj=_commands,
                )
            finally:
                sys.stdout.flush()  # a pipe that is closed, or a disk that is full, shows by now
    except InputError as error:
        return _fail(as_options(str(error), _commands()), _BAD_INPUT)
    except IncompleteError as error:
        return _fail(as_options(str(error), _commands()), _INCOMPLETE)
    except ModuleNotFoundError as error:
        if (missing := _not_installed(error)) is None:
            raise
        return _fail(str(missing), _BAD_INPUT)
    except OSError as error:  # a folder that may not be entered, a disk that fails
        rule = f"{error.strerror or error}"
        return _fail(f"{error.filename}: {rule}" if error.filename else rule, _BAD_INPUT)
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 0
        return _fail(interruption(arguments), code) if code == INTERRUPTED else code
    return 0


def _not_installed(error: ModuleNotFoundError) -> InputError | None:
    """Say which package a small installation lacks; None where a module of this package is missing."""
    package = str(error.name).partition(".")[0]
    if package == "reliab":
        return None
    return InputError(
        f"This command needs the package {package}",
        value="none installed",
        remedy=f"Install it with: python -m pip install {package}; or reliab, in place of reliab-core",
    )


def spread(arguments: Sequence[str], command: Any) -> Iterator[str]:  # noqa: ANN401 - Typer hides its type
    """Write `--option a b` as `--option a --option b` for options that may be repeated."""
    words_by_option: dict[str, list[str]] = {}  # by option, the words that it takes beside numbers
    current: str | None = None
    first = numeric = False
    for argument in arguments:
        if argument in (commands := getattr(command, "commands", {})):
            command = commands[argument]
            words_by_option = {
                name: str(option.metavar).removesuffix("...").split("|")
                for option in command.params
                if option.multiple
                for name in option.opts
            }
        if argument.startswith("-") and not _is_number(argument) and argument != "-":
            current, first = (argument, True) if argument in words_by_option else (None, False)
        elif first:
            first, numeric = False, _is_number(argument)
        elif (
            current in words_by_option
            and numeric
            and not (_is_number(argument) or argument in words_by_option[current])
        ):
            current = None  # a file after numbers is no number
        elif current is not None:
            yield current
        yield argument


def _is_number(text: str) -> bool:
    try:
        StatedValue.parse(remove_units(text, *UNITS))
    except InputError:
        return False
    return True


def _show_warning(message: Warning | str, *_details: object, **_more: object) -> None:
    """Show a warning as a line without the place in the code that gave it."""
    _say(f"Warning: {message}", typer.colors.YELLOW)


def _fail(message: str, code: int) -> int:
    kind = "" if code == INTERRUPTED else "Error: "
    _say(f"{kind}{message}", typer.colors.RED)
    return code


def _say(text: str, colour: str) -> None:
    is_coloured = False if os.environ.get("NO_COLOR") else None  # None: as the stream allows
    typer.secho(substitute_characters(printable(text), sys.stderr), err=True, fg=colour, color=is_coloured)
