"""The paper's meaning of "95 % confidence": the plug-in quantile of a fitted distribution."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import CurveName
from reliab.criterion.distributions import DISTRIBUTIONS, Lognormal
from reliab.criterion.methods.method import BoundMethod


@dataclass(frozen=True, kw_only=True)
class Quantile(BoundMethod):
    """Plug-in quantile: the fitted distribution is taken for the true one.

    Definition: the bound is the (1 − confidence) quantile of the distribution of maximum likelihood.
    The uncertainty of the fit is ignored, so that on average over suites of few motions fewer
    motions than stated exceed the bound.

    >>> logarithms = np.log([1.0, 2.0, 4.0])
    >>> bound = Quantile().lower_bound(logarithms, np.array(["K", "K", "L"]), 0.95)
    >>> round(float(np.exp(bound)), 4)
    0.7884
    """

    name: ClassVar[str] = "quantile"
    meaning: ClassVar[str] = (
        "the quantile of the fitted distribution, as in the paper: no allowance is made for how few "
        "motions there are"
    )
    curve: ClassVar[str] = CurveName.ELLIPSE
    joint_by_default: ClassVar[bool] = False

    distribution: str = Lognormal.name  # Name of the family, lognormal as in the paper by default

    def __post_init__(self) -> None:
        if self.distribution not in DISTRIBUTIONS:
            raise InputError(
                "Unknown distribution",
                value=self.distribution,
                remedy=f"Choose among {', '.join(DISTRIBUTIONS)}",
            )

    @property
    def assumes_lognormality(self) -> bool:
        """Whether the promise needs lognormal motions."""
        return self.distribution == Lognormal.name

    def mean_share(self, confidence: float, n_motions: int) -> float:
        """Share of further motions that exceed the quantile of a lognormal fit to n motions, on average.

        With mean m and standard deviation s (divisor n) of the logarithms, the bound is m − z s, and a
        further value lies above it with the probability T(z √((n − 1)/(n + 1))) of Student's t, n − 1
        degrees of freedom.
        """
        return float(
            scipy.special.stdtr(
                n_motions - 1,
                scipy.special.ndtri(confidence) * np.sqrt((n_motions - 1) / (n_motions + 1)),
            )
        )

    def _lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        del events
        centre = logarithms.mean()  # the families scale, and this keeps the exponential in range
        distribution = DISTRIBUTIONS[self.distribution].fit(np.exp(logarithms - centre))
        with np.errstate(divide="ignore"):  # a quantile of zero, below what a number can hold
            return float(centre + np.log(distribution.quantile(1.0 - confidence)))
