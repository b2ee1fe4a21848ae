"""Samples for the tests of the criterion."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion.ellipse_sample import EllipseSample

SampleOf = Callable[..., EllipseSample]


@pytest.fixture(scope="session")
def sample_from() -> SampleOf:
    """Make a sample of given logarithms, shape (motions, 2), two motions to an event unless said."""

    def make(logarithms: NDArray[np.float64], events: NDArray[np.int64] | None = None) -> EllipseSample:
        number = np.arange(len(logarithms))
        labels = number // 2 if events is None else events
        return EllipseSample(
            a=np.exp(logarithms[:, 0]),
            b=np.exp(logarithms[:, 1]),
            motions=number.astype(np.str_),
            events=labels.astype(np.str_),
            frequency=1.0,
            damping_ratio=0.02,
            threshold=0.05,
            metric="rms",
        )

    return make


@pytest.fixture(scope="session")
def two_sided(ellipses: xr.Dataset) -> xr.Dataset:
    """The same ellipses and smaller inscribed ones, for lags and wider for leads."""
    lag = xr.concat([ellipses, ellipses.assign(a=0.9 * ellipses["a"], b=0.8 * ellipses["b"])], dim="curve")
    lag = lag.assign_coords(curve=["ellipse", "inscribed"])
    lead = lag.assign(a=1.1 * lag["a"], b=1.7 * lag["b"] ** 1.05)
    return xr.concat([lag, lead], dim="side").assign_coords(side=["lag", "lead"])


@pytest.fixture(scope="session")
def ellipses(grouped_ellipses: xr.Dataset) -> xr.Dataset:
    """Ellipses of 60 motions of 20 earthquakes at six structures."""
    return grouped_ellipses
