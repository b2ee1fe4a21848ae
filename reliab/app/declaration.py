"""An argument of a question, declared once: type, unit, line of help, panel of the help, completion.

A question is a `TypedDict` whose fields are `Annotated[type, option(…)]` and whose docstring has a line for
each; questions share fields by deriving from groups. `single` makes one of an argument that no group holds,
such as the file to write. The command's options, and the signature and docstring of the Python function,
follow from it.

Each function takes the beginning of a word; what it needs is imported when the shell asks. If a file may
stand in place of a name, an empty word is left to the shell, which offers files.
"""

import re
import types
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import wraps
from inspect import Parameter, Signature, cleandoc, signature
from pathlib import Path
from typing import Annotated, Any, Final, ForwardRef, TypeVar, Union, get_args, get_origin

from reliab.core.files import require_ending
from reliab.core.progress import Progress
from reliab.core.stated_value import Names, Numbers, StatedValue


def _any_of(*names: str, takes_files: bool = False) -> Callable[[str], list[str]]:
    """Complete one of some names; `takes_files`: whether a file may stand in their place."""
    return lambda incomplete: _complete_names(incomplete, names) if incomplete or not takes_files else []


samples = _any_of("sample_test", takes_files=True)
campaigns = _any_of("rig_a", "rig_b", "rig_c", takes_files=True)
suites = _any_of("synthetic", takes_files=True)
results = _any_of("real_suite", takes_files=True)
metrics = _any_of("rms", "mte")
papers = _any_of("a4", "letter")


def studies(incomplete: str) -> list[str]:
    """Complete the name of a study that ships."""
    from reliab.core.shipped import shipped

    return _complete_names(
        incomplete, sorted(file.parent.name for file in shipped("studies", "").glob("*/study.toml"))
    )


def methods(incomplete: str) -> list[str]:
    """Complete the name of a meaning of confidence."""
    from reliab.criterion.methods.registry import METHODS

    return _complete_names(incomplete, METHODS)


def laws(incomplete: str) -> list[str]:
    """Complete the name of a law of natural frequency and damping ratio."""
    from reliab.criterion.laws.registry import FITTED_LAWS, MANY_MOTION_LAWS

    return _complete_names(incomplete, [*FITTED_LAWS, *MANY_MOTION_LAWS])


def _complete_names(incomplete: str, names: Iterable[str]) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]


Quantity = float | str | StatedValue
"""A number, a number with its standard deviation as text ("1±0.01"), or such a value."""

Quantities = Quantity | Sequence[Quantity]
"""One of them, or several."""

Files = str | Path | Sequence[str | Path]
"""Files, folders or names of what ships; one or several."""

UNITS: Final = ("Hz", "ms", "mm", "kg")
"""Units that may follow a number."""

_Function = TypeVar("_Function", bound=Callable[..., Any])
_Question = TypeVar("_Question")
_NOT_ONE = (types.UnionType, Union)


@dataclass(kw_only=True)
class Option:
    """How an argument is shown, and what it may be."""

    metavar: str
    panel: str  # Title of its part of the help
    help: str = ""  # One line, in which other arguments stand in backquotes; `group` gives it
    names: tuple[str, ...] = ()  # On the command line; the field's own, with dashes, by default
    default: Any = None
    is_advanced: bool = False  # Shown by --help-all only
    is_required: bool = False
    is_named: bool = True  # Else it stands without a name
    endings: tuple[str, ...] = ()  # Of a file to write
    idle_beside: tuple[str, ...] = ()  # A default of the laboratory has no effect beside these
    completion: Callable[[str], list[str]] | None = None  # Gives the names that begin as a word does
    limits: Mapping[str, Any] = field(default_factory=dict)  # What else Typer takes

    @property
    def unit(self) -> str:
        """Unit of the number, as its line of help states it; it may be written after the number."""
        return next((unit for unit in UNITS if f"[{unit}]" in self.help), "")

    def flags(self, name: str) -> tuple[str, ...]:
        """Names on the command line."""
        default_flag = f"--{name.replace('_', '-')}"
        return tuple(flag or default_flag for flag in self.names) or (default_flag,)

    def read_value(self, name: str, kind: Any, value: Any) -> Any:  # noqa: ANN401 - of many types
        """Check a value and make it what a function of the API works with, as its type says."""
        checked_value = self.check_value(value)
        if checked_value is None:
            return None
        if kind == Quantities:
            several = checked_value if isinstance(checked_value, list | tuple) else [checked_value]
            return [self.read_value(name, Quantity, item) for item in several]
        if kind == Quantity:
            is_read = isinstance(checked_value, StatedValue)
            return checked_value if is_read else StatedValue.parse(str(checked_value), f"value of `{name}`")
        return _read_object(str(kind), checked_value)

    def check_value(self, value: Any) -> Any:  # noqa: ANN401 - of many types
        """Refuse a file to write that is of another kind; take units off numbers."""
        if self.endings and value is not None:
            require_ending(value, *self.endings)
        return self.remove_unit(value)

    def remove_unit(self, value: Any) -> Any:  # noqa: ANN401 - of many types
        """Take the unit off the numbers of a text.

        >>> Panel("Structure").option("HZ", help="Frequency [Hz].").remove_unit("1.2 Hz ± 0.01 Hz")
        '1.2 ± 0.01'
        """
        if self.unit and isinstance(value, str):
            return remove_units(value, self.unit)
        if self.unit and isinstance(value, list | tuple):
            return [self.remove_unit(item) for item in value]
        return value


def _read_object(kind: str, value: Any) -> Any:  # noqa: ANN401 - of many types
    """Read the file or the texts that may stand in place of an object; anything else is what it is."""
    match kind.rpartition(" ")[2], value:
        case "Criterion", str() | Path():
            from reliab.criterion.criterion import Criterion

            return Criterion.read(value)
        case "Equipment", str() | Path():
            from reliab.assessment.budget.sizes import read_equipment

            return read_equipment(value)
        case "ForceChannel", Iterable():
            from reliab.assessment.measured_specimen.force_channel import ForceChannel

            texts = list(value)
            return ForceChannel.parse(texts) if texts else None
        case "Motion", str() | Path():
            from reliab.motions.loading import read_motion

            return read_motion(value)
        case "UpdatedModel", str() | Path():
            from reliab.simulation.hybrid_test.model_file import read_model

            return read_model(value)
    return value


def remove_units(text: str, *units: str) -> str:
    """Take units off the numbers of a text.

    >>> remove_units("35.5 kg", *UNITS), remove_units("35.5 kN", *UNITS)
    ('35.5', '35.5 kN')
    """
    return re.sub(rf"(?<=[\d.])\s*(?:{'|'.join(units)})(?![a-z/])", "", text, flags=re.IGNORECASE)


@dataclass(frozen=True)
class Panel:
    """A part of the help; it declares what it shows."""

    title: str

    def option(self, metavar: str, **details: Any) -> Option:  # noqa: ANN401
        """Declare an argument that has a name on the command line."""
        return Option(metavar=metavar, panel=self.title, **details)

    def advanced(self, metavar: str, **details: Any) -> Option:  # noqa: ANN401
        """Declare one that few need; --help-all shows it."""
        return self.option(metavar, is_advanced=True, **details)

    def flag(self, **details: Any) -> Option:  # noqa: ANN401
        """Declare one that is true if it is named."""
        return self.option("", default=False, **details)

    def advanced_flag(self, **details: Any) -> Option:  # noqa: ANN401
        """Declare one of these that few need."""
        return self.flag(is_advanced=True, **details)


def argument(metavar: str, **details: Any) -> Option:  # noqa: ANN401
    """Declare what stands without a name on the command line; it is required unless a default is given."""
    is_required = "default" not in details
    return Option(metavar=metavar, panel="", is_named=False, is_required=is_required, **details)


def group(question: type[_Question]) -> type[_Question]:
    """Give the arguments of a question their help: a line each of its docstring, or all of it to its own.

    >>> from typing import Annotated, TypedDict
    >>> @group
    ... class Structure(TypedDict):
    ...     '''A structure.
    ...
    ...     f: Natural frequency [Hz].
    ...     '''
    ...     f: Annotated[float, Panel("Structure").option("HZ")]
    >>> collect_options(Structure)["f"][1].help
    'Natural frequency [Hz].'
    """
    text = cleandoc(question.__doc__ or "")
    options = {name: get_args(annotation)[1] for name, annotation in question.__annotations__.items()}
    lines = re.findall(r"^(\w+): (.+(?:\n +.+)*)", text, flags=re.MULTILINE)
    for name, help_ in lines or [(list(options)[-1], text)]:
        options[name].help = " ".join(help_.split())
    return question


def single(name: str, kind: Any, option: Option, help_: str) -> type:  # noqa: ANN401 - a type
    """Declare a question of one argument.

    >>> collect_options(single("rig", str, argument("RIG"), "Folder of the rig."))["rig"][1].help
    'Folder of the rig.'
    """
    option.help = help_
    return type(name, (), {"__annotations__": {name: Annotated[kind, option]}})


def collect_options(*questions: type) -> dict[str, tuple[Any, Option]]:
    """Types and declarations of the arguments of questions by their names."""
    options = {}
    for question in questions:
        for name, annotation in question.__annotations__.items():
            kind, declaration = get_args(annotation)
            options[name] = _plain(kind), declaration
    return options


def _plain(kind: Any) -> Any:  # noqa: ANN401 - a type
    """Type of a value that is stated: without None; a text where a type is not imported."""
    if isinstance(kind, ForwardRef):
        return kind.__forward_arg__.removesuffix(" | None")
    if get_origin(kind) in _NOT_ONE:
        kinds = tuple(part for part in get_args(kind) if part is not types.NoneType)
        return Union[kinds]  # noqa: UP007 - of a tuple
    return kind


def asks(*questions: type, as_stated: bool = False) -> Callable[[_Function], _Function]:
    """Complete a function that takes questions as keywords: its signature, docstring and defaults.

    It is called with all arguments, which are checked and read as their types say, a number as a
    `StatedValue` and a file as the object that it describes, or left `as_stated`; an unknown name is a
    TypeError. An argument of its own that a question declares is checked and documented alike.
    """
    options = collect_options(*questions)

    def complete(function: _Function) -> _Function:
        parameters = {
            name: item
            for name, item in signature(function).parameters.items()
            if item.kind is not Parameter.VAR_KEYWORD
        }
        defaults = {name: option.default for name, (_, option) in options.items() if name not in parameters}

        def check(name: str, value: Any) -> Any:  # noqa: ANN401 - of many types
            if name not in options:
                return value
            kind, option = options[name]
            return option.check_value(value) if as_stated else option.read_value(name, kind, value)

        @wraps(function)
        def ask(*values: Any, **keywords: Any) -> Any:  # noqa: ANN401 - as the function
            if unknown := keywords.keys() - parameters.keys() - options.keys():
                raise TypeError(f"{function.__name__}() has no argument {', '.join(sorted(unknown))}")
            positional = [*map(check, parameters, values), *values[len(parameters) :]]
            in_order = (name for name in {**parameters, **options} if name in keywords)
            arguments = {name: check(name, keywords[name]) for name in in_order}
            return function(*positional, **{**defaults, **arguments})

        option_parameters = (
            Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=_text_of(options[name][0]))
            for name, default in defaults.items()
        )
        return_annotation = signature(function).return_annotation
        ask.__signature__ = Signature(  # type: ignore[attr-defined]
            [*sorted(parameters.values(), key=lambda item: item.kind), *option_parameters],
            return_annotation=return_annotation,
        )
        ask.__doc__ = _document(cleandoc(function.__doc__ or ""), parameters, options, return_annotation)
        return ask  # type: ignore[return-value]

    return complete


_SECTION = "Parameters\n----------\n"
_LATER_SECTION = re.compile(r"\n\n(?=(?:Returns|Raises|Notes|Examples)\n-)")
_TASKS: Mapping[str, str] = {
    "progress": "Called after each test, motion or file with how many are done, and how many there are.",
    "setting": "Paper, title, date, and name and logo of the laboratory of a report.",
}
"""Texts of arguments that no command line states."""


def _document(
    text: str, parameters: Mapping[str, Parameter], options: Mapping[str, tuple[Any, Option]], answer: object
) -> str:
    """Add the arguments that a docstring lacks, and what is returned if that is a result with a docstring."""
    head, section, tail = text.partition(_SECTION)
    existing, _, remainder = tail.partition("\n\n")
    if not section:
        head, *later_sections = _LATER_SECTION.split(text, maxsplit=1)
        head, existing, remainder = f"{head}\n\n", "", "".join(later_sections)
    if not remainder.startswith("Returns") and isinstance(answer, type) and "reliab." in answer.__module__:
        sentence = str(answer.__doc__).partition("\n")[0]
        remainder = f"Returns\n-------\n{answer.__name__}\n    {sentence}\n\n{remainder}"
    kinds = {name: kind for name, (kind, _) in options.items() if name not in parameters}
    kinds = {name: item.annotation for name, item in parameters.items()} | kinds
    required = [name for name, item in parameters.items() if item.default is Parameter.empty]
    texts = {**_TASKS, **{name: option.help for name, (_, option) in options.items()}}
    entries = [
        f"{name} : {_text_of(kind)}{'' if name in required else ', optional'}\n    {texts[name]}"
        for name, kind in kinds.items()
        if name in texts and f"\n{name} : " not in f"\n{existing}"
    ]
    section_text = "\n".join(filter(None, (existing, *entries)))
    return f"{head}{_SECTION}{section_text}\n\n{remainder}".rstrip()


_TYPE_WORDS: Mapping[Any, str] = {
    Quantity: "float, str or StatedValue",
    Quantities: "float, str or StatedValue, or several of them",
    Numbers: "float or sequence of float",
    Names: "str or sequence of str",
    str | Path: "str or pathlib.Path",
    Iterable[str]: "iterable of str",
    Files: "str, pathlib.Path or sequence of these",
    Progress: "callable",
}


def _text_of(kind: Any) -> str:  # noqa: ANN401 - a type
    """Type as a docstring names it."""
    if kind in _TYPE_WORDS:
        return _TYPE_WORDS[kind]
    text = kind.__name__ if isinstance(kind, type) else str(kind).removesuffix(" | None")
    return re.sub(r"\b(?:typing|collections\.abc)\.", "", text).replace(" | ", " or ")
