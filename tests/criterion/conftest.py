"""Samples for the tests of the criterion."""

import pytest
import xarray as xr


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
