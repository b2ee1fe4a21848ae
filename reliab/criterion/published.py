"""Criteria of published laws."""

from typing import TYPE_CHECKING

import numpy as np

from reliab.core.vocabulary import CurveName, Metric
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import room
from reliab.criterion.ellipse_sample import sample_of
from reliab.criterion.laws.registry import MANY_MOTION_LAWS, find_law
from reliab.criterion.provenance import Provenance

if TYPE_CHECKING:
    import xarray as xr


def published_criterion(name: str) -> Criterion:
    """Make the criterion of a published or corrected law.

    Parameters
    ----------
    name : str
        A law that promises a confidence over motions, such as "guo_2017_18".

    Returns
    -------
    Criterion
        At 5 % RMS^R and the 95 % that the paper states.

    Raises
    ------
    InputError
        If there is no such law.

    Examples
    --------
    Case 1 of Table 6:

    >>> criterion = published_criterion("guo_2017_18")
    >>> round(float(criterion.index(1.0039, 0.39e-3, 1.0, 0.02)), 3)
    0.956
    """
    law = find_law(MANY_MOTION_LAWS, name)
    return Criterion(
        law=law,
        threshold=0.05,
        metric=str(Metric.RMS),
        confidence=0.95,
        method="quantile",
        joint=False,
        provenance=Provenance(source=f"Guo and others (2017), {law.equation}", n_motions=100, n_events=19),
    )


def exact_share(
    criterion: Criterion, ellipses: "xr.Dataset", frequency: float, damping_ratio: float
) -> dict[str, float]:
    """Count the motions whose own ellipse contains that of a printed law.

    `frequency`, `damping_ratio`: the structure [Hz, -]; the nearest one of the ellipses is taken. Returns
    `share` of the motions [-], `n_motions`, and the structure, `f` [Hz] and `xi` [-].
    """
    f, xi = (
        float(values[np.argmin(np.abs(np.log(values / target)))])
        for values, target in (
            (ellipses["f"].values, frequency),
            (ellipses["xi"].values, damping_ratio),
        )
    )
    sample = sample_of(
        ellipses,
        frequency=f,
        damping_ratio=xi,
        threshold=criterion.threshold,
        metric=criterion.metric,
        curve=CurveName.ELLIPSE,
    )
    a, b = (float(limit) for limit in criterion.limits(f, xi))
    return {
        "share": float(np.mean(room(sample, a, b) >= 1.0)),
        "n_motions": sample.n_motions,
        "f": f,
        "xi": xi,
    }
