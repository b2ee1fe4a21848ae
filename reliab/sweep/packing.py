"""Variables of a dataset in whole steps of their logarithm, as they stand in the files that ship."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from reliab.steps_of_logarithm import NEIGHBOURS, STEP, UNKNOWN, from_steps, to_steps


def packed(
    dataset: xr.Dataset, names: Sequence[str], *, step: float, along: Sequence[str], unknown: str
) -> xr.Dataset:
    """Round variables to steps of their logarithm, for a small file that :func:`read_netcdf` reads.

    `names`: the variables, positive; `step`: of the natural logarithm; `along`: dimensions along which
    neighbours resemble each other; `unknown`: variable of the dataset that is not zero where they have no
    value. Returns the dataset with whole numbers in their place.
    """
    stored = {}
    for name in names:
        axes = [dataset[name].get_axis_num(dimension) for dimension in along]
        steps = to_steps(dataset[name].values.astype(np.float64), step, axes)
        attributes = {STEP: step, NEIGHBOURS: " ".join(along), UNKNOWN: unknown}
        stored[name] = dataset[name].copy(data=steps).assign_attrs(attributes)
    return dataset.assign(stored)


def unpacked(dataset: xr.Dataset) -> xr.Dataset:
    """Read what :func:`packed` rounded; other variables stay."""
    return dataset.assign(
        {name: _numbers(dataset, str(name)) for name in dataset if UNKNOWN in dataset[name].attrs}
    )


def _numbers(dataset: xr.Dataset, name: str) -> xr.DataArray:
    stored = dataset[name]
    attributes = dict(stored.attrs)
    step, along, unknown = (attributes.pop(key) for key in (STEP, NEIGHBOURS, UNKNOWN))
    axes = [stored.get_axis_num(dimension) for dimension in along.split()]
    numbers = stored.copy(data=from_steps(stored.values, float(step), axes))
    numbers.attrs = attributes
    return numbers.where(dataset[unknown] == 0).transpose(*stored.dims)
