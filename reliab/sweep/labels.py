"""Labelling of datasets: every variable and coordinate carries its full name and unit."""

import xarray as xr

from reliab.vocabulary import LABELS


def with_labels(dataset: xr.Dataset) -> xr.Dataset:
    """Give every known variable and coordinate its `long_name` and `units`."""
    for name, label in LABELS.items():
        if name in dataset.variables:
            dataset[name].attrs.update(long_name=label.long_name, units=label.units)
    return dataset
