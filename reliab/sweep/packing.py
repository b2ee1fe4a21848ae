"""Variables of a dataset in whole steps of their logarithm, as they stand in the files that ship."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from reliab.steps_of_logarithm import NEIGHBOURS, STEP, UNKNOWN, numbers_of, to_steps


def packed(
    dataset: xr.Dataset, names: Sequence[str], *, step: float, along: Sequence[str], unknown: str
) -> xr.Dataset:
    """Round variables to steps of their logarithm, for a small file that :func:`read_netcdf` reads.

    `names`: the variables, positive; `step`: of the natural logarithm; `along`: dimensions along which
    neighbours resemble each other; `unknown`: variable of the dataset that is not zero where they have no
    value. Returns the dataset with whole numbers in their place.
    """
    stored = {
        name: stepped(dataset[name], step=step, along=along).assign_attrs({UNKNOWN: unknown})
        for name in names
    }
    return dataset.assign(stored)


def stepped(values: xr.DataArray, *, step: float, along: Sequence[str]) -> xr.DataArray:
    """Round positive numbers to steps of their logarithm, told by differences along dimensions.

    The attributes of what is returned say how, in place of those of the numbers with these names.
    """
    axes = [values.get_axis_num(name) for name in along]
    steps = to_steps(values.values.astype(np.float64), step, axes)
    return values.copy(data=steps).assign_attrs({STEP: step, NEIGHBOURS: " ".join(along)})


def numbered(stored: xr.DataArray) -> xr.DataArray:
    """Read what :func:`stepped` rounded."""
    names = [str(name) for name in stored.dims]
    numbers = stored.copy(data=numbers_of(stored.values, stored.attrs, names))
    numbers.attrs = {name: value for name, value in stored.attrs.items() if name not in {STEP, NEIGHBOURS}}
    return numbers


def unpacked(dataset: xr.Dataset) -> xr.Dataset:
    """Read what :func:`packed` rounded; other variables stay."""
    return dataset.assign(
        {name: _numbers(dataset, str(name)) for name in dataset if UNKNOWN in dataset[name].attrs}
    )


def _numbers(dataset: xr.Dataset, name: str) -> xr.DataArray:
    numbers = numbered(dataset[name])
    unknown = dataset[numbers.attrs.pop(UNKNOWN)]
    return numbers.where(unknown == 0).transpose(*numbers.dims)
