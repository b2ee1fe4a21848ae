"""Laws to and from plain dictionaries, for JSON."""

from dataclasses import asdict
from typing import Any, Final, cast

from reliab.criterion.laws.law import Law
from reliab.criterion.laws.one_structure import OneStructure
from reliab.errors import InputError

LAWS: Final[dict[str, type[Law]]] = {each.name: each for each in (OneStructure,)}
"""Every law by its name."""


def law_to_dict(law: Law) -> dict[str, Any]:
    """Name and parameters of a law.

    Parameters
    ----------
    law : Law
        A law of `LAWS`, a dataclass.

    Returns
    -------
    dict
        Key "name" and one key for each parameter.

    Examples
    --------
    >>> law = OneStructure(a=5.3e-5, b=1.04, frequency=1.0, damping_ratio=0.02)
    >>> law_from_dict(law_to_dict(law)) == law
    True
    """
    return {"name": law.name, **asdict(cast("Any", law))}


def law_from_dict(content: dict[str, Any]) -> Law:
    """Make a law from its name and parameters.

    Parameters
    ----------
    content : dict
        As `law_to_dict` gives it.

    Returns
    -------
    Law
        The law.

    Raises
    ------
    InputError
        If there is no law of that name.
    """
    parameters = dict(content)
    name = parameters.pop("name", None)
    if name not in LAWS:
        raise InputError("A law must be known", value=name, remedy=f"Choose among {', '.join(LAWS)}")
    return LAWS[name](**parameters)
