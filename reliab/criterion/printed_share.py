"""How many real ground motions keep a printed law, measured on ellipses and not taken from the paper."""

import numpy as np
import xarray as xr

from reliab.criterion.criterion import Criterion
from reliab.criterion.ellipse_sample import sample_of
from reliab.criterion.law_scaling import room
from reliab.vocabulary import CurveName


def printed_share(
    criterion: Criterion, ellipses: xr.Dataset, frequency: float, damping_ratio: float
) -> dict[str, float]:
    """Count the motions whose own ellipse contains that of a printed law.

    `frequency`, `damping_ratio` [Hz, -].
    Returns `share` of the motions [-], `n_motions`, and the structure, `f` [Hz] and `xi` [-].
    """
    f, xi = (
        float(values[np.argmin(np.abs(np.log(values / wanted)))])
        for values, wanted in (
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
