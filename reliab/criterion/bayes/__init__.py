"""Bayesian fits: exact posteriors and ensemble sampling."""

from reliab.criterion.bayes.bivariate_lognormal import BivariateLognormal
from reliab.criterion.bayes.diagnostics import ConvergenceWarning, Diagnostics
from reliab.criterion.bayes.hierarchical import Hierarchical
from reliab.criterion.bayes.model import Model, Parameter, prior_predictive
from reliab.criterion.bayes.normal_cell import NormalCell
from reliab.criterion.bayes.posterior_sample import PosteriorSample
from reliab.criterion.bayes.sampling import Ensembles, sample

__all__ = [
    "BivariateLognormal",
    "ConvergenceWarning",
    "Diagnostics",
    "Ensembles",
    "Hierarchical",
    "Model",
    "NormalCell",
    "Parameter",
    "PosteriorSample",
    "prior_predictive",
    "sample",
]
