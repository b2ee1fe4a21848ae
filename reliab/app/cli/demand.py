"""The options of a command, declared once as fields of a dataclass; each is used or refused.

A field is called as its option is, with underscores for dashes, unless `name` says otherwise; several
commands may share what `option`, `flag` or `argument` declares.
"""

import inspect
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields
from functools import partial, wraps
from pathlib import Path
from typing import Annotated, Any, ClassVar, TypeVar

import typer

from reliab.app.api.arguments import unused
from reliab.core.errors import InputError
from reliab.core.progress import shows_tasks

WRITTEN = ("json_target", "out", "csv", "report", "corrected", "figure")
"""Options that name a file to write."""

_BROUGHT_UP_TO_DATE = {"out": ("channels", "tests")}  # a table among the tests of a pattern is no test
_Answer = TypeVar("_Answer")
_Options = TypeVar("_Options", bound="Demand")


@dataclass(frozen=True, kw_only=True)
class _Declared:
    """How Typer shows an option or argument, and its default; `MISSING` where it must be given."""

    make: Callable[..., Any]
    name: str
    default: Any
    details: Mapping[str, Any]

    def of_typer(self, field_name: str) -> Any:  # noqa: ANN401 - Typer's types are private
        """Declare it to Typer."""
        if self.make is typer.Argument:
            return self.make(**self.details)
        return self.make(self.name or f"--{field_name.replace('_', '-')}", **self.details)


def option(
    metavar: str,
    help: str,  # noqa: A002 - Typer's word
    *,
    name: str = "",
    default: Any = None,  # noqa: ANN401 - of any type
    **details: Any,  # noqa: ANN401 - what else `typer.Option` takes
) -> Any:  # noqa: ANN401 - the default of a field
    """Declare an option with a value."""
    details |= {"metavar": metavar or None, "help": help}
    return _Declared(make=typer.Option, name=name, default=default, details=details)


def flag(help: str, *, name: str = "") -> Any:  # noqa: A002, ANN401 - as above
    """Declare an option without a value."""
    return _Declared(make=typer.Option, name=name, default=False, details={"help": help})


def argument(metavar: str, help: str, *, default: Any = MISSING, **details: Any) -> Any:  # noqa: A002, ANN401
    """Declare what stands without a name."""
    details |= {"metavar": metavar, "help": help}
    return _Declared(make=typer.Argument, name="", default=default, details=details)


@dataclass(frozen=True, kw_only=True)
class Demand:
    """Options of a command: each field that a derived class declares by `option`, `flag` or `argument`."""

    given: tuple[str, ...] = ()  # Options that the command line states; the others are defaults
    in_options: Callable[[str], str] = str  # Writes the arguments that a message names as options

    belongs_to: ClassVar[Mapping[str, str]] = {}
    """By option the one without which it has no effect."""
    idle_beside: ClassVar[Mapping[str, Collection[str]]] = {}
    """By option those that have no effect together with it; a laboratory's defaults of them are left out."""

    def __init_subclass__(cls) -> None:
        """Make a field of each declaration; a shared one becomes one of each class."""
        for name, declared in list(vars(cls).items()):
            if isinstance(declared, _Declared):
                option_field = field(default=declared.default, metadata={"declared": declared})
                setattr(cls, name, option_field)

    def ask(
        self,
        service: Callable[..., _Answer],
        *uses: str,
        why: str = "",
        **arguments: Any,  # noqa: ANN401 - whatever the service takes
    ) -> _Answer:
        """Ask a service with the options that it takes by name; refuse others, but what the command uses.

        `why`: beside or without what the others have no meaning; `arguments`: what else the service is told.
        """
        taken = [name for name in inspect.signature(service).parameters if hasattr(self, name)]
        self.refuse_all_but({*taken, *uses}, why)
        idle = {
            name
            for beside, names in self.idle_beside.items()
            if getattr(self, beside) is not None
            for name in names
            if name not in self.given
        }
        values = {**{name: getattr(self, name) for name in taken}, **arguments}
        stated = (name for name, value in values.items() if value is not None and name not in idle)
        return service(**{name: values[name] for name in stated})

    def refuse_to_overwrite(self) -> None:
        """Refuse to write over a file that the command reads, such as the only recording of a test."""
        for name in WRITTEN:
            target = getattr(self, name, None)
            if target is None or not Path(target).is_file():
                continue
            for source in self._read_beside(name):
                if source.is_file() and source.samefile(target):
                    raise InputError(
                        "A command must not write over a file that it reads",
                        value=f"`{name}` {target}",
                        remedy="Name another file",
                        where=str(source),
                    )

    def _read_beside(self, written: str) -> Iterator[Path]:
        """Give the files that may be read, but those that an option may bring up to date."""
        for item in fields(self):
            if item.name not in (*WRITTEN, *_BROUGHT_UP_TO_DATE.get(written, ()), "given", "in_options"):
                value = getattr(self, item.name)
                named = value if isinstance(value, list) else [value]
                yield from (Path(one) for one in named if isinstance(one, str | Path))

    def refuse_all_but(self, names: Collection[str], why: str = "") -> None:
        """Refuse what the command line states and nothing would use."""
        for name in self.given:
            if name not in names:
                raise unused(name, why or f"without `{self.belongs_to[name]}`")


def takes(options: type[_Options]) -> Callable[[Callable[[_Options], None]], Callable[..., None]]:
    """Make a command of a function that takes its options as one object; Typer reads them from its fields."""

    def declare(command: Callable[[_Options], None]) -> Callable[..., None]:
        @wraps(command)
        def run(context: typer.Context, **values: Any) -> None:  # noqa: ANN401 - of many types
            given = tuple(name for name in values if _is_given(context, name))
            say = partial(_in_options, root=context.find_root())
            demand = options(given=given, in_options=say, **values)
            demand.refuse_to_overwrite()
            from reliab.app.cli.output import progress_bar

            with shows_tasks(progress_bar):
                command(demand)

        context = inspect.Parameter("context", inspect.Parameter.KEYWORD_ONLY, annotation=typer.Context)
        run.__signature__ = inspect.Signature([context, *_parameters(options)])  # type: ignore[attr-defined]
        return run

    return declare


def _in_options(message: str, root: Any) -> str:  # noqa: ANN401 - Typer hides its type
    """Write the arguments that a message names as options, of any command where the program can make all."""
    return as_options(message, root.obj() if root.obj else root.command)


def _is_given(context: typer.Context, name: str) -> bool:
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def _parameters(options: type[Demand]) -> Iterator[inspect.Parameter]:
    """Options of a class in the order in which its help names them: its own before those that it shares."""
    declared: dict[str, Field[Any]] = {item.name: item for item in fields(options)}
    shared = {item.name for item in fields(Demand)}
    for home in options.__mro__:
        for name in inspect.get_annotations(home):
            if name in declared and name not in shared:
                taken = declared.pop(name)
                yield inspect.Parameter(
                    name,
                    inspect.Parameter.KEYWORD_ONLY,
                    annotation=Annotated[taken.type, taken.metadata["declared"].of_typer(name)],
                    default=inspect.Parameter.empty if taken.default is MISSING else taken.default,
                )


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
