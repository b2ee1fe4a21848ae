"""Methods by the names they have on the command line."""

from dataclasses import fields
from typing import Any, Final, cast

from reliab.core.errors import InputError
from reliab.core.registry import Registry
from reliab.criterion.methods.dirichlet import Dirichlet
from reliab.criterion.methods.hierarchical.method import HierarchicalNormal, HierarchicalRobust
from reliab.criterion.methods.method import Method
from reliab.criterion.methods.order_statistic import OrderStatistic
from reliab.criterion.methods.predictive import Predictive
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.methods.tolerance import Tolerance

METHODS: Final[Registry[type[Method]]] = Registry(
    noun="method",
    base=Method,
    group="reliab.criterion_methods",
    items=(
        *(Quantile, Tolerance, Predictive, Dirichlet, OrderStatistic),
        *(HierarchicalNormal, HierarchicalRobust),
    ),
    name_of=lambda method: method.name,
)
"""Every method by its name; other packages register classes derived from `Method`."""

RECOMMENDED_METHOD: Final = Dirichlet.name
"""The method to rely on, used jointly for a and b: the default everywhere."""


def method_of(name: str, **settings: object) -> Method:
    """Make the method of a name.

    >>> method_of("tolerance", assurance=0.9)
    Tolerance(assurance=0.9)
    """
    kind: Any = METHODS.find(name)
    explicit_settings = {key: value for key, value in settings.items() if value is not None}
    for unknown in explicit_settings.keys() - _parameters(name):
        takers = [method for method in METHODS if unknown in _parameters(method)]
        raise InputError(
            f"The method {name} has no {unknown}",
            value=explicit_settings[unknown],
            remedy=f"Leave it out, or choose among {', '.join(takers)}",
        )
    method: Method = kind(**explicit_settings)
    return method


def _parameters(name: str) -> set[str]:
    return {parameter.name for parameter in fields(cast("Any", METHODS[name]))}
