"""The paper's meaning of "95 % confidence": the plug-in quantile of a fitted distribution."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.distributions import DISTRIBUTIONS, Lognormal
from reliab.criterion.methods.method import Method
from reliab.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Quantile(Method):
    """Plug-in quantile: the fitted distribution is taken for the true one.

    Definition: the bound is the (1 − confidence) quantile of the distribution of maximum likelihood.
    The uncertainty of the fit is ignored, so that on average over suites of few motions fewer
    motions than stated exceed the bound.

    Parameters
    ----------
    distribution : str, optional
        Name of the family, lognormal as in the paper by default.

    Raises
    ------
    InputError
        If there is no family of that name.

    Examples
    --------
    >>> logarithms = np.log([1.0, 2.0, 4.0])
    >>> bound = Quantile().lower_bound(logarithms, np.array(["K", "K", "L"]), 0.95)
    >>> round(float(np.exp(bound)), 4)
    0.7884
    """

    name: ClassVar[str] = "quantile"
    exchangeable: ClassVar[str] = "motions, each counted as independent"

    distribution: str = Lognormal.name

    def __post_init__(self) -> None:
        if self.distribution not in DISTRIBUTIONS:
            raise InputError(
                "The distribution must be known",
                value=self.distribution,
                remedy=f"Choose among {', '.join(DISTRIBUTIONS)}",
            )

    @property
    def assumes_lognormality(self) -> bool:
        """Whether the promise needs lognormal motions."""
        return self.distribution == Lognormal.name

    def _lower_bound(
        self, logarithms: NDArray[np.float64], events: NDArray[np.str_], confidence: float
    ) -> float:
        del events
        centre = logarithms.mean()  # the families scale, and this keeps the exponential in range
        fitted = DISTRIBUTIONS[self.distribution].fit(np.exp(logarithms - centre))
        return float(centre + np.log(fitted.quantile(1.0 - confidence)))
