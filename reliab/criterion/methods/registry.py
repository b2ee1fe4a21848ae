"""Methods by the names they have on the command line."""

from dataclasses import fields
from typing import Any, Final, cast

from reliab.criterion.methods.bootstrap import Bootstrap
from reliab.criterion.methods.conformal import Conformal
from reliab.criterion.methods.dirichlet import Dirichlet
from reliab.criterion.methods.hierarchical import HIERARCHICAL, HierarchicalPosterior
from reliab.criterion.methods.method import Method
from reliab.criterion.methods.order_statistic import OrderStatistic
from reliab.criterion.methods.posterior import Posterior
from reliab.criterion.methods.predictive import Predictive
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.methods.tolerance import Tolerance
from reliab.errors import InputError

METHODS: Final[dict[str, type[Method]]] = {
    each.name: each
    for each in (
        *(Quantile, Tolerance, Posterior, Predictive),
        *(Dirichlet, OrderStatistic, Conformal, Bootstrap),
    )
}
"""Every method by its name."""

RECOMMENDED: Final = Dirichlet.name
"""The method to rely on, used jointly for a and b."""


def method_of(name: str, **settings: object) -> Method:
    """Make the method of a name.

    Parameters
    ----------
    name : str
        One of `METHODS`.
    **settings
        Parameters of the method; None stands for its default.

    Returns
    -------
    Method
        The method.

    Raises
    ------
    InputError
        If there is none of that name, or it has no such parameter.

    Examples
    --------
    >>> method_of("tolerance", assurance=0.9)
    Tolerance(assurance=0.9)
    """
    if name not in METHODS:
        raise InputError("The method must be known", value=name, remedy=f"Choose among {', '.join(METHODS)}")
    return METHODS[name](**_settings_of(METHODS[name], name, settings))


def any_method_of(name: str, **settings: object) -> Method | HierarchicalPosterior:
    """Make the method of a name, one for each structure alone or for all structures at once.

    Parameters
    ----------
    name : str
        One of `METHODS` or `HIERARCHICAL`.
    **settings
        As for :func:`method_of`.

    Returns
    -------
    Method or HierarchicalPosterior
        The method.

    Raises
    ------
    InputError
        As for :func:`method_of`.

    Examples
    --------
    >>> any_method_of("hierarchical", steps=400)
    HierarchicalPosterior(robust=False, assurance=None, steps=400)
    """
    if name in HIERARCHICAL:
        given: dict[str, Any] = _settings_of(HierarchicalPosterior, name, settings)
        return HierarchicalPosterior(robust=HIERARCHICAL[name], **given)
    if name not in METHODS:
        every = ", ".join((*METHODS, *HIERARCHICAL))
        raise InputError("The method must be known", value=name, remedy=f"Choose among {every}")
    return method_of(name, **settings)


def _settings_of(kind: type, name: str, settings: dict[str, object]) -> dict[str, object]:
    """Keep settings that are given, or say that a method has no such thing."""
    given = {key: value for key, value in settings.items() if value is not None}
    known = {each.name for each in fields(cast("Any", kind))}
    for unknown in given.keys() - known:
        takers = [each for each, one in _ALL.items() if unknown in {f.name for f in fields(cast("Any", one))}]
        raise InputError(
            f"The method {name} has no {unknown}",
            value=given[unknown],
            remedy=f"Leave it out, or choose among {', '.join(takers)}",
        )
    return given


_ALL: Final[dict[str, type]] = {**METHODS, **dict.fromkeys(HIERARCHICAL, HierarchicalPosterior)}
