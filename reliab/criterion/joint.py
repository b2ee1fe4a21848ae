"""Limits of a and b from a sample, each for itself or both together."""

import numpy as np

from reliab.criterion.ellipse_sample import EllipseSample
from reliab.criterion.methods.method import Method


def limits(
    sample: EllipseSample, method: Method, confidence: float, *, joint: bool = False
) -> tuple[float, float]:
    """Derive limits a and b at a confidence.

    Each for itself, as in the paper, a share `confidence` of the motions has a larger a, and the same
    share, but not the same motions, a larger b. *Jointly*, the share holds for both together: the two
    logarithms are standardised, the worse of the two stands for the motion, and its lower bound is
    carried back to a and b, so that both lie equally deep in their own distributions.

    Parameters
    ----------
    sample : EllipseSample
        Ellipses of one structure at one error.
    method : Method
        What the confidence means.
    confidence : float
        Stated share of the motions, in (0, 1).
    joint : bool, optional
        Whether a and b hold together.

    Returns
    -------
    a, b : float
        The limits [-] and [ms²]; zero when the motions are too few for the method's promise.

    Examples
    --------
    >>> from reliab.criterion.methods import Quantile
    >>> logarithms = np.random.default_rng(1).multivariate_normal([0, 0], [[1.0, 0.5], [0.5, 1.0]], 5000)
    >>> a, b = np.exp(logarithms.T)
    >>> names = np.arange(5000).astype(str)
    >>> sample = EllipseSample(
    ...     a=a, b=b, motions=names, events=names,
    ...     frequency=1.0, damping_ratio=0.02, threshold=0.05, metric="rms",
    ... )
    >>> for joint in (False, True):
    ...     least_a, least_b = limits(sample, Quantile(), 0.9, joint=joint)
    ...     print(round(float(((a >= least_a) & (b >= least_b)).mean()), 2))
    0.84
    0.91
    """
    if not joint:
        a, b = (
            method.lower_bound(values, sample.events, confidence) for values in (sample.log_a, sample.log_b)
        )
        return float(np.exp(a)), float(np.exp(b))
    logarithms = np.stack([sample.log_a, sample.log_b])
    centre, spread = logarithms.mean(axis=1), logarithms.std(axis=1)
    worse = ((logarithms - centre[:, None]) / spread[:, None]).min(axis=0)
    depth = method.lower_bound(worse, sample.events, confidence)
    a, b = np.exp(centre + spread * depth)
    return float(a), float(b)
