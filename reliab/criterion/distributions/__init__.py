"""Distributions of a and b over ground motions, one per file."""

from typing import Final

from reliab.criterion.distributions.distribution import Distribution
from reliab.criterion.distributions.empirical import Empirical
from reliab.criterion.distributions.gamma import Gamma
from reliab.criterion.distributions.gaussian_mixture import LogGaussianMixture
from reliab.criterion.distributions.lognormal import Lognormal
from reliab.criterion.distributions.skew_normal import LogSkewNormal
from reliab.criterion.distributions.student_t import LogStudentT
from reliab.criterion.distributions.weibull import Weibull

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
