"""Distributions, Bayesian fits, laws and the criterion."""

from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.ellipse_sample import EllipseSample, sample_of
from reliab.criterion.published import published_criterion

__all__ = [
    "Criterion",
    "EllipseSample",
    "derive_criterion",
    "published_criterion",
    "read_ellipses",
    "sample_of",
]
