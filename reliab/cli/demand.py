"""The options of a command, declared once as fields of a dataclass; each is used or refused."""

import inspect
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, fields
from functools import partial, wraps
from typing import Any, ClassVar, TypeVar

import typer

from reliab.api import unused
from reliab.cli.option_names import as_options

_Answer = TypeVar("_Answer")
_Options = TypeVar("_Options", bound="Demand")


@dataclass(frozen=True, kw_only=True)
class Demand:
    """Options of a command: each field that a derived class declares, `Annotated` with its `typer.Option`."""

    given: tuple[str, ...] = ()  # Options that the command line states; the others are defaults
    in_options: Callable[[str], str] = str  # Writes the arguments that a message names as options

    belongs_to: ClassVar[Mapping[str, str]] = {}
    """By option the one without which it has no meaning."""
    idle_beside: ClassVar[Mapping[str, Collection[str]]] = {}
    """By option those that have no meaning beside it; a laboratory's defaults of them are left out."""

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
            say = partial(as_options, command=context.find_root().command)
            command(options(given=given, in_options=say, **values))

        context = inspect.Parameter("context", inspect.Parameter.KEYWORD_ONLY, annotation=typer.Context)
        run.__signature__ = inspect.Signature([context, *_parameters(options)])  # type: ignore[attr-defined]
        return run

    return declare


def _is_given(context: typer.Context, name: str) -> bool:
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def _parameters(options: type[Demand]) -> Iterator[inspect.Parameter]:
    """Options of a class in the order in which its help names them: its own before those that it shares."""
    declared: dict[str, Field[Any]] = {field.name: field for field in fields(options)}
    shared = {field.name for field in fields(Demand)}
    for home in options.__mro__:
        for name in vars(home).get("__annotations__", {}):
            if name in declared and name not in shared:
                field = declared.pop(name)
                yield inspect.Parameter(
                    name,
                    inspect.Parameter.KEYWORD_ONLY,
                    annotation=field.type,
                    default=inspect.Parameter.empty if field.default is MISSING else field.default,
                )
