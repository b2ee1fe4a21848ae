"""Make commands of questions: an option is declared once (`reliab.app.declaration`), and used or refused."""

import inspect
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from datetime import date
from functools import partial, wraps
from glob import glob
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeVar

import typer
from typer.core import TyperCommand, TyperGroup

from reliab.app.api.arguments import refuse_unused
from reliab.app.cli.output import progress_bar, speaking, write_json
from reliab.app.declaration import Files, Option, Quantities, Quantity, collect_options
from reliab.app.options import HELP, JSON, PANELS
from reliab.core.errors import InputError
from reliab.core.progress import shows_tasks
from reliab.core.stated_value import Names, Numbers, percentage_as_number

if TYPE_CHECKING:
    from reliab.report.setting import ReportSetting


_TABLE_BEGINS = b"file,"


def files_of(tests: Sequence[Path] | None, out: Path | None) -> list[Path]:
    """Files of the tests, also those that a pattern such as ``*.csv`` names where the shell does not."""
    files = []
    for path in tests or []:
        names = [] if path.exists() else glob(str(path))  # noqa: PTH207 - absolute patterns too
        files += [Path(name) for name in sorted(names)] or [path]
    if out in files and not _is_table(out):
        raise InputError("This would overwrite a test", value=f"`out` {out}", remedy="Name another file")
    return [file for file in files if file != out]


def _is_table(path: Path) -> bool:
    """Tell whether a file is the table of an earlier run, which a pattern names among the tests."""
    try:
        return path.read_bytes()[: len(_TABLE_BEGINS)] == _TABLE_BEGINS
    except OSError:
        return True  # it is not there yet


OUTPUT_OPTIONS = ("json_target", "out", "csv", "report", "corrected", "figure")
"""Options that name a file to write."""

_BROUGHT_UP_TO_DATE = {"out": ("channels", "tests")}  # a table among the tests of a pattern is no test
_Answer = TypeVar("_Answer")
_READ_AS: Final[Mapping[Any, Any]] = {
    Quantity: str,
    Quantities: list[str],
    Numbers: list[float],
    Names: list[str],
    Files: list[str],
    Iterable[str]: list[str],
    str | Path: Path,
    **{kind: kind for kind in (bool, int, float, str, Path, list[Path], tuple[str, str])},
}
"""What Typer reads for the type of an argument; texts or a file for one that is not imported."""


class Request:
    """What a command line asks: values by the names of the arguments, and which of them it states."""

    def __init__(
        self,
        values: Mapping[str, Any],
        *,
        options: Mapping[str, Option],
        given: tuple[str, ...] = (),
        write_as_options: Callable[[str], str] = str,
        belongs_to: Mapping[str, str] | None = None,
    ) -> None:
        """Keep what is asked.

        `write_as_options` writes arguments that a message names as options; `belongs_to`: by option what it
        needs.
        """
        self._values, self._options, self._belongs_to = values, options, belongs_to or {}
        self.given_names, self.write_as_options = given, write_as_options

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - of many types
        if name.startswith("_") or name not in self._values:
            raise AttributeError(name)
        return self._values[name]

    def ask(
        self,
        service: Callable[..., _Answer],
        *uses: str,
        reason: str = "",
        **arguments: Any,  # noqa: ANN401 - whatever the service takes
    ) -> _Answer:
        """Ask a service with the options that it takes by name; refuse others, but --json and what is used.

        `reason`: beside or without what the others have no meaning; `arguments`: what else it is told.
        """
        service_options = [name for name in inspect.signature(service).parameters if name in self._values]
        self.refuse_all_but({*service_options, *uses, "json_target"}, reason)
        call_arguments = {**{name: self._values[name] for name in service_options}, **arguments}
        effective = (
            name for name, value in call_arguments.items() if value is not None and not self._is_idle(name)
        )
        return service(**{name: call_arguments[name] for name in effective})

    def answer(
        self,
        service: Callable[..., _Answer],
        screen: Callable[[_Answer], None],
        *uses: str,
        content: Callable[[Any], Any] = lambda answer: answer.to_dict(),
        **arguments: Any,  # noqa: ANN401 - whatever the service takes
    ) -> _Answer:
        """Ask a service; write what it answers as JSON if that is asked for, else show it on the screen.

        `content`: plain values of the answer; the other arguments are those of `ask`.
        """
        answer = self.ask(service, *uses, **arguments)
        target = self._values["json_target"]
        if target is None or not write_json(content(answer), target):
            screen(answer)
        return answer

    def setting(self) -> "ReportSetting":
        """How the report is set."""
        from reliab.report.setting import ReportSetting

        return ReportSetting(
            title=self.title or "",
            date=None if self.date is None else _parse_date(self.date),
            paper=self.paper,
            laboratory=self.laboratory or "",
            logo=self.logo,
        )

    def _is_idle(self, name: str) -> bool:
        """Tell whether a laboratory's default has no effect beside what is stated."""
        neighbours = self._options[name].idle_beside if name in self._options else ()
        return name not in self.given_names and any(
            self._values.get(neighbour) is not None for neighbour in neighbours
        )

    def refuse_to_overwrite(self) -> None:
        """Refuse to write over a file that the command reads, such as the only recording of a test."""
        for name in OUTPUT_OPTIONS:
            target = self._values.get(name)
            if target is None or not Path(target).is_file():
                continue
            for source in self._read_beside(name):
                if source.is_file() and source.samefile(target):
                    raise InputError(
                        "This would overwrite a file that the command reads",
                        value=f"`{name}` {target}",
                        remedy="Name another file",
                        where=str(source),
                    )

    def _read_beside(self, output: str) -> Iterator[Path]:
        """Give the files that may be read, but those that an option may bring up to date."""
        for name, value in self._values.items():
            if name not in (*OUTPUT_OPTIONS, *_BROUGHT_UP_TO_DATE.get(output, ())):
                paths = value if isinstance(value, list) else [value]
                yield from (Path(path) for path in paths if isinstance(path, str | Path))

    def refuse_all_but(self, names: Collection[str], reason: str = "") -> None:
        """Refuse what the command line states and nothing would use."""
        for name in self.given_names:
            if name not in names:
                raise refuse_unused(name, reason or f"without `{self._belongs_to[name]}`")


def _parse_date(text: str) -> date:
    try:
        return date.fromisoformat(text)
    except ValueError:
        remedy = "Write it as year, month and day, 2026-03-01"
        raise InputError("The `date` is not understood", value=repr(text), remedy=remedy) from None


def takes(
    *questions: type, needs: Mapping[str, str] | None = None, idle_beside: Mapping[str, str] | None = None
) -> Callable[[Callable[[Request], None]], Callable[..., None]]:
    """Make a command of a function; its options are the arguments of the questions, and --json.

    `needs`: by option the one without which it has no effect; `idle_beside`: by option one more beside which
    a laboratory's default of it has none.
    """
    declarations = {**collect_options(*questions), **collect_options(JSON)}
    for name, neighbour in (idle_beside or {}).items():
        kind, option = declarations[name]
        declarations[name] = kind, replace(option, idle_beside=(*option.idle_beside, neighbour))
    options = {name: option for name, (_, option) in declarations.items()}

    def declare(command: Callable[[Request], None]) -> Callable[..., None]:
        @wraps(command)
        def run(context: typer.Context, **values: Any) -> None:  # noqa: ANN401 - of many types
            given_names = tuple(name for name in values if _is_given(context, name))
            say = partial(_name_options, root=context.find_root())
            request = Request(
                values, options=options, given=given_names, write_as_options=say, belongs_to=needs
            )
            request.refuse_to_overwrite()
            with speaking(say), shows_tasks(progress_bar):
                command(request)

        context = inspect.Parameter("context", inspect.Parameter.KEYWORD_ONLY, annotation=typer.Context)
        ordered = sorted(declarations.items(), key=lambda item: _place(item[1][1]))
        parameters = [context, *(_parameter(name, *item, options) for name, item in ordered)]
        run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        run.advanced_names = frozenset(  # type: ignore[attr-defined]
            name for name, option in options.items() if option.is_advanced
        )
        return run

    return declare


_PLACES = {panel.title: place for place, panel in enumerate(PANELS)}


def _place(option: Option) -> tuple[bool, int, bool]:
    """Place in the help: arguments before options, panel by panel, what is used every day first."""
    return option.is_named, _PLACES.get(option.panel, 0), option.is_advanced


def _parameter(
    name: str,
    kind: Any,  # noqa: ANN401 - a type
    option: Option,
    options: Mapping[str, Option],
) -> inspect.Parameter:
    """Parameter of which Typer makes the option."""
    read_as: Any = _READ_AS.get(kind)
    if read_as is None:
        read_as = list[str] if kind.startswith("Iterable") else Path
    flags = {option_name: declaration.flags(option_name)[0] for option_name, declaration in options.items()}
    help_ = _replace_by_flags(option.help, flags)
    details: dict[str, Any] = {"metavar": option.metavar or None, "help": help_, **option.limits}
    if option.completion is not None:
        details["autocompletion"] = option.completion
    if option.endings:
        details["callback"] = option.check_value
    if option.unit and read_as == list[float]:
        details["parser"] = partial(_number, option)
    if option.is_named:
        typer_parameter = typer.Option(*option.flags(name), rich_help_panel=option.panel, **details)
    else:
        typer_parameter = typer.Argument(**details)
    if option.default is None and not option.is_required:
        read_as = read_as | None
    return inspect.Parameter(
        name,
        inspect.Parameter.KEYWORD_ONLY,
        annotation=Annotated[read_as, typer_parameter],
        default=inspect.Parameter.empty if option.is_required else option.default,
    )


def _number(option: Option, text: str) -> float:
    """Read a number that may be followed by its unit."""
    return float(option.remove_unit(text))


def _refusal_of_number(error: typer.BadParameter) -> InputError | None:
    """Refuse what is no number in words of our own; None where something else was wrong."""
    problems: list[dict[str, Any]] = getattr(error.__cause__, "errors", list)()
    if not problems or problems[0]["type"] not in _NO_NUMBER:
        return None
    option, text = getattr(error.param, "opts", ["an argument"])[0], str(problems[0]["input"])
    return InputError(
        f"The value of {option} is no {_NO_NUMBER[problems[0]['type']]}",
        value=repr(text),
        remedy=percentage_as_number(text) or "Write digits, with a point before decimals",
    )


_NO_NUMBER = {
    "float_parsing": "number",
    "value_error": "number",
    "int_parsing": "whole number",
    "int_from_float": "whole number",
}
_SHOWS_ALL = "reliab.shows_all"


class Command(TyperCommand):
    """A command whose help leaves out what few need, unless it is asked for all."""

    @property
    def advanced_names(self) -> frozenset[str]:
        """Names of what few need."""
        return getattr(self.callback, "advanced_names", frozenset())

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:  # noqa: ANN401 - Typer hides its types
        """Read the arguments; refuse two values of an option that takes one."""
        try:
            remaining: list[str] = super().parse_args(ctx, list(args))
        except typer.BadParameter as error:
            raise _refusal_of_number(error) or error from None
        _, _, parameters = self.make_parser(ctx).parse_args(args)
        for parameter in parameters:
            takes_one = parameter.nargs == 1 and not (
                parameter.multiple or getattr(parameter, "is_flag", False)
            )
            if takes_one and parameters.count(parameter) > 1:
                raise InputError(f"`{parameter.name}` takes one value", value="several", remedy="Give one")
        return remaining

    def get_params(self, ctx: Any) -> list[Any]:  # noqa: ANN401 - Typer hides its types
        """Return the parameters; the help's own stand in the last panel."""
        params = _without_types(super().get_params(ctx))
        help_option = params.pop()
        help_option.rich_help_panel = HELP.title
        if not self.advanced_names:
            return [*params, help_option]
        help_all = copy(help_option)
        help_all.opts, help_all.name, help_all.callback = ["--help-all"], "help_all", _show_all
        help_all.help = "Show further options, too."
        return [*params, help_all, help_option]

    def format_help(self, ctx: Any, formatter: Any) -> None:  # noqa: ANN401 - as above
        """Print the help."""
        left_out = (
            []
            if ctx.meta.get(_SHOWS_ALL)
            else [item for item in self.params if item.name in self.advanced_names]
        )
        for item in left_out:
            item.hidden = True  # type: ignore[attr-defined]
        super().format_help(ctx, formatter)
        for item in left_out:
            item.hidden = False  # type: ignore[attr-defined]


class Group(TyperGroup):
    """Several commands."""

    def get_params(self, ctx: Any) -> list[Any]:  # noqa: ANN401 - Typer hides its types
        """Return the parameters of all commands."""
        return _without_types(super().get_params(ctx))


def _without_types(params: Sequence[Any]) -> list[Any]:
    """Show no types of arguments and flags in the help."""
    for param in params:
        if param.param_type_name == "argument" or param.is_flag:
            param.display_type_rich = _show_no_type
    return list(params)


def _show_no_type(**_: Any) -> None:  # noqa: ANN401 - Typer hides its types
    """Leave out Python's name of a type: the name of an argument says what it takes, a flag takes nothing."""


def _show_all(context: Any, _option: Any, is_asked: bool) -> None:  # noqa: ANN401, FBT001 - Click's callback
    if is_asked:
        context.meta[_SHOWS_ALL] = True
        typer.echo(context.get_help())
        raise typer.Exit


def _name_options(message: str, root: Any) -> str:  # noqa: ANN401 - Typer hides its type
    """Write the arguments that a message names as options, of any command where the program can make all."""
    return as_options(message, root.obj() if root.obj else root.command)


def _is_given(context: typer.Context, name: str) -> bool:
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


_ARGUMENT = re.compile(r"`([a-z]\w*)(?:=([^`]+))?`")


def as_options(message: str, command: Any) -> str:  # noqa: ANN401 - Typer hides its type
    """Write the arguments that a message names as options of the command line.

    `` `time_units="ms"` `` as ``--time-units ms``; what names no option stays as it is.

    >>> import typer
    >>> from reliab.app.cli import application
    >>> command = typer.main.get_command(application("assess"))
    >>> as_options('Give `xi` or `time_units="ms"`, as `reliab info` says of `this`', command)
    'Give --xi or --time-units ms, as `reliab info` says of `this`'
    """
    return _replace_by_flags(message, dict(_flags(command)))


def _replace_by_flags(text: str, flags: Mapping[str, str]) -> str:
    """Write arguments in backquotes as flags."""

    def option(argument: re.Match[str]) -> str:
        name, value = argument.groups()
        if name not in flags:
            return argument.group()
        return flags[name] if value is None else f"{flags[name]} {value.strip(chr(34))}"

    return _ARGUMENT.sub(option, text)


def _flags(command: Any) -> Iterator[tuple[str, str]]:  # noqa: ANN401
    """Options of all commands by their names in Python; one name means one thing everywhere."""
    for parameter in command.params:
        if parameter.opts[0].startswith("--"):
            yield parameter.name, parameter.opts[0]
    for subcommand in getattr(command, "commands", {}).values():
        yield from _flags(subcommand)
