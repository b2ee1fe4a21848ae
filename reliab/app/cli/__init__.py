"""The command line `reliab`: one file for each command, or for those of one subject.

Only the command that is asked is imported, and at its top only Typer; numerics, and Rich for tables and bars,
are imported when it needs them, so that it answers at once.
"""

import logging
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from reliab.app.cli.commands import OUTPUT_OPTIONS, Command, Group, as_options
from reliab.app.cli.output import replace_unwritable_characters
from reliab.app.declaration import UNITS, remove_units
from reliab.core.described_files import read_toml
from reliab.core.encodings import printable, substitute_characters
from reliab.core.errors import INTERRUPTED, IncompleteError, InputError
from reliab.core.interruption import notice_interruption
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
    **dict.fromkeys(("run", "report", "samples", "fetch", "info"), "reliab.app.cli.studies"),
    **dict.fromkeys(("compare", "extrapolate"), "reliab.app.cli.assess"),
    **dict.fromkeys(("design", "explore"), "reliab.app.cli.criterion"),
    **dict.fromkeys(("simulate", "ellipses"), "reliab.app.cli.motions"),
    "calibrate": "reliab.app.cli.record",
    "desk": "reliab.desk.command",
}
"""Modules of commands that share one or stand in a folder; the others have one of their name."""

DEFAULTS_FILE: Final = "reliab.toml"
"""Name of the file in the user's configuration folder."""

CONFIG_VARIABLE: Final = "RELIAB_CONFIG"
"""Environment variable that names another file."""

CONFIG_OPTION: Final = "--config"
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
        if self.path is None and Path(DEFAULTS_FILE).is_file():
            named = f"{CONFIG_OPTION} {DEFAULTS_FILE}"
            yield f"{DEFAULTS_FILE} of this folder is not read. If it is yours, name it: {named}."


def user_file() -> Path:
    """Place of the file in the user's configuration folder."""
    return Path(typer.get_app_dir("reliab")) / DEFAULTS_FILE


def remove_config(arguments: Sequence[str]) -> tuple[list[str], str | None]:
    """Take the option that names the file of defaults from a command line; return its value too.

    >>> remove_config(["assess", "--config", "lab.toml", "test.csv"])
    (['assess', 'test.csv'], 'lab.toml')
    """
    remaining, config = [], None
    iterator = iter(arguments)
    for argument in iterator:
        name, equals, value = argument.partition("=")
        if name != CONFIG_OPTION:
            remaining.append(argument)
            continue
        config = value if equals else next(iterator, "")
        if not config:
            raise InputError(f"{CONFIG_OPTION} needs a file", remedy="Name it")
    return remaining, config


def read_defaults(commands: Callable[[], Any], config: str | None = None) -> Defaults:
    """Read a laboratory's defaults, which may be of any of the commands that are made where there are some.

    `named`: the file that the command line names; by default that of the environment or of the user's folder.
    """
    config_path = config or os.environ.get(CONFIG_VARIABLE)
    path = Path(config_path) if config_path else user_file()
    if not config_path and not path.is_file():
        return Defaults()
    content = read_toml(
        path,
        rule="The file of defaults must be readable TOML",
        remedy="Correct it, or name another"
        if config
        else f"Correct it, or name another with {CONFIG_OPTION}",
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


_GOES_ON: Final = {
    "simulate": ("--out", "The motions that are finished are kept; go on with --resume."),
    "run": ("", "The stages that are finished are kept; the same command goes on from them."),
    "criterion": ("--chains", "The chains are kept; the same command goes on with them."),
    "diagnose": ("--out", "The chains are kept; the same command goes on with them."),
}
"""By command the option that must have been given, and what goes on then."""

_NOTHING_HALF = "No file is half written; run the command again."


def interruption(arguments: Sequence[str]) -> str:
    """Say what Ctrl-C has left.

    >>> interruption(["simulate", "--out", "results.zarr"])
    'Interrupted. The motions that are finished are kept; go on with --resume.'
    >>> interruption(["explore"])
    'Interrupted. No file is half written; run the command again.'
    """
    command = arguments[0] if arguments else ""
    option, kept_work = _GOES_ON.get(command, ("", ""))
    is_given = any(argument.partition("=")[0] == option for argument in arguments)
    return f"Interrupted. {kept_work if kept_work and (is_given or not option) else _NOTHING_HALF}"


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
        with notice_interruption(), warnings.catch_warnings():
            arguments, config = remove_config(arguments)
            command = _find_command(arguments)
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
