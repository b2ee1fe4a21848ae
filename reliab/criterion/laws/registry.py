"""Laws by the names they have on the command line, and to and from JSON."""

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any, Final, TypeVar, cast, get_type_hints

from reliab.core.described_files import faults_in_words
from reliab.core.errors import InputError
from reliab.core.registry import Registry
from reliab.criterion.laws.dimensionless import Dimensionless
from reliab.criterion.laws.exponential import Exponential
from reliab.criterion.laws.guo_2017 import CORRECTED_EQUATIONS, PUBLISHED_EQUATIONS, SINGLE_MOTION_EQUATIONS
from reliab.criterion.laws.law import Law, LogLinearLaw
from reliab.criterion.laws.power import Power
from reliab.criterion.laws.table import TabulatedLimits

FittedLaw = type[TabulatedLimits] | type[LogLinearLaw]
"""A law that is fitted to the limits of a grid of structures."""

LawKind = TypeVar("LawKind")

FITTED_LAWS: Final[Registry[FittedLaw]] = Registry(
    noun="law",
    base=Law,
    group="reliab.laws",
    items=(TabulatedLimits, Dimensionless, Power, Exponential),
    name_of=lambda law: law.name,
)
"""Laws that are fitted, by name; other packages register classes derived from `LogLinearLaw`."""

MANY_MOTION_LAWS: Final[dict[str, Law]] = {
    law.name: law()
    for law in (*PUBLISHED_EQUATIONS, *CORRECTED_EQUATIONS)
    if law not in SINGLE_MOTION_EQUATIONS
}
"""Published and corrected laws that promise a confidence over motions, by name."""

_PRINTED_LAWS: Final[dict[str, type[Law]]] = {
    law.name: law for law in (*PUBLISHED_EQUATIONS, *CORRECTED_EQUATIONS)
}


def law_to_dict(law: Law) -> dict[str, Any]:
    """Name and parameters of a law.

    >>> law = Power(
    ...     coefficients_a=(-1.0, 0.0, 2.0),
    ...     coefficients_b=(1.0, -2.0, 2.0),
    ...     frequency=(1, 2),
    ...     damping_ratio=(0.02, 0.1),
    ... )
    >>> law_from_dict(law_to_dict(law)) == law
    True
    """
    return {"name": law.name, **asdict(cast("Any", law))}


def law_from_dict(content: Mapping[str, Any]) -> Law:
    """Make a law from its name and parameters."""
    parameters = {key: _tuples(value) for key, value in content.items() if key != "name"}
    laws: dict[str, type[Law]] = {**FITTED_LAWS, **_PRINTED_LAWS}
    law = find_law(laws, content.get("name"))
    field_names = {parameter.name for parameter in fields(cast("Any", law))}
    if parameters.keys() != field_names:
        raise InputError(
            f"The law {law.name} has the parameters {', '.join(sorted(field_names)) or 'none'}",
            value=", ".join(sorted(parameters.keys() ^ field_names)) + " missing or unknown",
            remedy="Derive the criterion again",
        )
    return law(**{name: _check_value(law, name, value) for name, value in parameters.items()})


def _check_value(law: type[Law], name: str, value: object) -> object:
    """Return the value of a parameter if it is of the type that the law states."""
    from pydantic import ConfigDict, TypeAdapter, ValidationError

    schema = TypeAdapter(get_type_hints(law)[name], config=ConfigDict(strict=True, allow_inf_nan=False))
    try:
        return schema.validate_python(value)
    except ValidationError as error:
        raise InputError(
            f"The parameter {name} of the law {law.name} must be numbers, as the law states them",
            value=faults_in_words(error),
            remedy="Derive the criterion again",
        ) from None


def find_law(laws: Mapping[str, LawKind], name: object) -> LawKind:
    """Take a law by its name, or say which there are."""
    if not isinstance(name, str) or name not in laws:
        raise InputError("Unknown law", value=name, remedy=f"Choose among {', '.join(laws)}")
    return laws[name]


def _tuples(value: object) -> object:
    return tuple(_tuples(item) for item in value) if isinstance(value, list | tuple) else value
