"""Ellipses of motions that are drawn from a distribution that is known."""

import numpy as np
import pytest
import xarray as xr

from reliab.core.vocabulary import ELLIPSE_DIMENSIONS
from reliab.criterion.laws.law import scales


def _draw_motions(*, events: int, frequencies=(1.0,), skewness=0.0, seed=0) -> xr.Dataset:
    """Two motions an earthquake; ln a and ln b correlated by 0.9, half the variance between earthquakes."""
    rng = np.random.default_rng(seed)
    factor = np.linalg.cholesky([[1.0, 0.9], [0.9, 1.0]]).T

    def deviation(rows):
        normal = rng.normal(size=(rows, len(frequencies), 2))
        skewed_table = rng.exponential(size=(rows, len(frequencies), 2)) - 1.0
        return (np.sqrt(1.0 - skewness) * normal + np.sqrt(skewness) * skewed_table) @ factor

    total = 0.6 * np.sqrt(0.5) * (np.repeat(deviation(events), 2, axis=0) + deviation(2 * events))
    scale_a, scale_b = scales(np.asarray(frequencies), 0.02)
    values = {"a": 0.4 * scale_a * np.exp(total[..., 0]), "b": 0.3 * scale_b * np.exp(total[..., 1])}
    names = np.repeat([f"E{number}" for number in range(events)], 2)
    fill = (slice(None), slice(None), *(None,) * (len(ELLIPSE_DIMENSIONS) - 2))
    return xr.Dataset(
        {name: (ELLIPSE_DIMENSIONS, array[fill]) for name, array in values.items()},
        coords={
            "motion": [f"{name}/{number}" for number, name in enumerate(names)],
            "event": ("motion", names),
            "f": list(frequencies),
            "xi": [0.02],
            "threshold": [0.05],
            "metric": ["rms"],
            "curve": ["ellipse"],
            "side": ["lag"],
        },
    )


@pytest.fixture
def draw_ellipses():
    return _draw_motions
