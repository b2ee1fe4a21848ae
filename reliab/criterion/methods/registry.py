"""Methods by the names they have on the command line."""

from dataclasses import fields
from typing import Any, Final, cast

from reliab.criterion.methods.bootstrap import Bootstrap
from reliab.criterion.methods.conformal import Conformal
from reliab.criterion.methods.dirichlet import Dirichlet
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
        Parameters of methods; each method takes those it has, and None stands for its default.

    Returns
    -------
    Method
        The method.

    Raises
    ------
    InputError
        If there is none of that name.

    Examples
    --------
    >>> method_of("tolerance", assurance=0.9)
    Tolerance(assurance=0.9)
    """
    if name not in METHODS:
        raise InputError("The method must be known", value=name, remedy=f"Choose among {', '.join(METHODS)}")
    method = METHODS[name]
    known = {each.name for each in fields(cast("Any", method))}
    return method(**{key: value for key, value in settings.items() if key in known and value is not None})
