"""Posteriors: exact ones of normal values, and ensembles of walkers with their diagnostics.

Nothing here knows what the parameters mean; criteria and diagnoses bring their own models.
"""

from reliab.sampling.diagnostics import ConvergenceWarning, Diagnostics
from reliab.sampling.ensembles import Ensembles, sample
from reliab.sampling.model import Model, Parameter
from reliab.sampling.normal_values import NormalValues
from reliab.sampling.posterior_sample import PosteriorSample

__all__ = [
    "ConvergenceWarning",
    "Diagnostics",
    "Ensembles",
    "Model",
    "NormalValues",
    "Parameter",
    "PosteriorSample",
    "sample",
]
