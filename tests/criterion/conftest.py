"""Samples for the tests of the criterion."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion import EllipseSample, read_ellipses
from reliab.criterion.scaling import scales
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


@pytest.fixture(scope="session")
def ellipses() -> xr.Dataset:
    """Ellipses of 60 motions of 20 earthquakes at six structures, skewed, correlated and grouped."""
    rng = np.random.default_rng(2017)
    f, xi = np.array([0.5, 1.0, 2.0]), np.array([0.02, 0.05])
    event = np.repeat(np.arange(20), 3)
    effect = 0.3 * rng.normal(size=20)[event][:, None, None]
    common = effect + rng.gamma(2.0, 0.35, (60, 3, 2))
    log_alpha = -1.6 + 0.2 * np.log(f)[:, None] + common + 0.05 * rng.normal(size=common.shape)
    log_beta = -2.0 + 0.8 * common + 0.05 * rng.normal(size=common.shape)
    scale_a, scale_b = scales(f[:, None], xi[None, :])
    dims = ("motion", "f", "xi", "threshold", "metric", "curve")
    a, b = (np.exp(x) * s for x, s in ((log_alpha, scale_a), (log_beta, scale_b)))
    return xr.Dataset(
        {name: (dims, each[..., None, None, None]) for name, each in (("a", a), ("b", b))},
        coords={
            "motion": [f"E{e}/M{m}" for m, e in enumerate(event)],
            "event": ("motion", [f"E{e}" for e in event]),
            "checksum": ("motion", [f"{m:064d}" for m in range(60)]),
            "f": f,
            "xi": xi,
            "threshold": [0.05],
            "metric": ["rms"],
            "curve": ["ellipse"],
        },
        attrs={"window": "record"},
    )


@pytest.fixture(scope="session")
def two_sided(ellipses: xr.Dataset) -> xr.Dataset:
    """The same ellipses and smaller inscribed ones, for lags and wider for leads."""
    lag = xr.concat([ellipses, ellipses.assign(a=0.9 * ellipses["a"], b=0.8 * ellipses["b"])], dim="curve")
    lag = lag.assign_coords(curve=["ellipse", "inscribed"])
    lead = lag.assign(a=1.1 * lag["a"], b=1.7 * lag["b"] ** 1.05)
    return xr.concat([lag, lead], dim="side").assign_coords(side=["lag", "lead"])
