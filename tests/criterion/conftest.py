"""Samples for the tests of the criterion."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion import EllipseSample, read_ellipses
from reliab.shipped import shipped

SampleOf = Callable[..., EllipseSample]


@pytest.fixture(scope="session")
def printed_table2() -> xr.Dataset:
    """The paper's Table 2."""
    return read_ellipses(shipped("datasets", "paper/table2.csv"))


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
