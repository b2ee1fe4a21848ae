"""Distributions of a and b over ground motions, by their names."""

from typing import Final

from reliab.criterion.distributions.distribution import Distribution
from reliab.criterion.distributions.normal_kernels import Empirical, LogGaussianMixture
from reliab.criterion.distributions.scipy_family import Gamma, Lognormal, LogSkewNormal, LogStudentT, Weibull

DISTRIBUTIONS: Final[dict[str, type[Distribution]]] = {
    family.name: family
    for family in (Lognormal, LogStudentT, LogSkewNormal, Gamma, Weibull, LogGaussianMixture, Empirical)
}
"""Every distribution by its name."""

__all__ = [
    "DISTRIBUTIONS",
    "Distribution",
    "Empirical",
    "Gamma",
    "LogGaussianMixture",
    "LogSkewNormal",
    "LogStudentT",
    "Lognormal",
    "Weibull",
]
