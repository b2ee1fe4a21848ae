"""Simulation-based calibration: whether a sampler and its model agree about uncertainty.

Parameters are drawn from the prior, data from the model at these parameters, and a posterior from the data.
If all is right, the rank of the true parameter among draws of its posterior is uniform.

References
----------
Talts, S. and others (2018). Validating Bayesian inference algorithms with simulation-based calibration.
arXiv:1804.06788.
"""

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.progress import Progress, silent
from reliab.sampling.ensembles import Ensembles, draw
from reliab.sampling.model import Model

DRAWS = 99
"""Draws of a posterior among which the true parameter is ranked."""

_BINS = 10


def calibration_ranks(
    model: Model, *, fits: int, steps: int, seed: int = 2017, progress: Progress = silent
) -> NDArray[np.int64]:
    """Rank true parameters among draws of their posteriors.

    Returns (fits, parameters).

    >>> from reliab.sampling import NormalValues
    >>> calibration_ranks(NormalValues(values=np.zeros(10)), fits=2, steps=200).shape
    (2, 2)
    """
    rng = np.random.default_rng(seed)
    ranks = np.empty((fits, len(model.parameters)), dtype=np.int64)
    for number, truth in enumerate(model.draw_prior(fits, rng)):
        settings = Ensembles(steps=steps, count=1, seed=seed + number)
        posterior = draw(model.simulate(truth, rng), settings)
        chosen = rng.choice(posterior.flat, DRAWS, replace=False)
        ranks[number] = (chosen < truth).sum(axis=0)
        progress(number + 1, fits)
    return ranks


def uniformity(ranks: NDArray[np.int64]) -> NDArray[np.float64]:
    """p-values of the hypothesis that ranks are uniform, by the χ² test over ten bins.

    `ranks` (fits, parameters); returns (parameters,).

    >>> ranks = np.random.default_rng(1).integers(0, 100, (500, 2))
    >>> bool((uniformity(ranks) > 0.01).all()), bool((uniformity(ranks // 2) > 0.01).any())
    (True, False)
    """
    edges = np.linspace(0, DRAWS + 1, _BINS + 1)
    counts = np.stack([np.histogram(of_parameter, edges)[0] for of_parameter in ranks.T])
    return np.asarray(scipy.stats.chisquare(counts, axis=1).pvalue)
