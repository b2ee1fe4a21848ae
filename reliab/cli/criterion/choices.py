"""`reliab criterion --list`: methods, laws and distributions by name, in their own words."""

from dataclasses import fields
from typing import Any

from reliab.cli.output import console
from reliab.criterion.distributions import DISTRIBUTIONS
from reliab.criterion.laws import FITTED, OF_MANY_MOTIONS
from reliab.criterion.methods import METHODS


def show_choices() -> None:
    """Print what --method, --law and --distribution may be, with what each means."""
    laws = {**FITTED, **OF_MANY_MOTIONS}
    _show("--method", {name: _of_method(method) for name, method in METHODS.items()})
    _show("--law", {name: str(law.equation) for name, law in laws.items()})
    _show("--distribution", {name: _first_sentence(family) for name, family in DISTRIBUTIONS.items()})


def _of_method(method: Any) -> str:  # noqa: ANN401 - a class of the registry
    assured = any(field.name == "assurance" for field in fields(method))
    return f"{method.meaning}{' (takes --assurance)' if assured else ''}"


def _first_sentence(family: type) -> str:
    return (family.__doc__ or "").partition(".")[0]


def _show(option: str, meanings: dict[str, str]) -> None:
    terminal = console()
    terminal.print(f"{option}:", style="bold")
    for name, meaning in meanings.items():
        terminal.print(f"  {name}: {meaning}", markup=False, highlight=False, soft_wrap=True)
