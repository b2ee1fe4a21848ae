"""Names, units and data on ground motions that every dataset carries."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from reliab.core.vocabulary import LABELS, Dimension
from reliab.motions.motion import Motion, outline_of


def label_variables(dataset: xr.Dataset) -> xr.Dataset:
    """Give every known variable and coordinate its `long_name` and `units`."""
    for name, label in LABELS.items():
        if name in dataset.variables:
            dataset[name].attrs.update(long_name=label.long_name, units=label.units)
    return dataset


def motion_coordinates(motions: Sequence[Motion]) -> dict[str, xr.Variable]:
    """Coordinates along the dimension of the motions.

    Returns names, earthquakes, durations [s], time steps [s], peak accelerations [m/s²] and checksums.
    """
    columns = {
        "motion": np.array([motion.name for motion in motions], dtype=np.str_),
        "event": np.array([motion.event for motion in motions], dtype=np.str_),
        "duration": np.array([motion.duration for motion in motions]),
        "dt": np.array([motion.time_step for motion in motions]),
        "pga": np.array([motion.peak_acceleration for motion in motions]),
        "checksum": np.array([motion.checksum for motion in motions], dtype=np.str_),
    }
    return {name: xr.Variable((Dimension.MOTION,), values) for name, values in columns.items()}


def outlines_of(motions: Sequence[Motion]) -> xr.DataArray:
    """Outlines of records, by which copies are recognised, along the dimension of the motions."""
    outlines = np.array([outline_of(motion) for motion in motions], dtype=np.str_)
    label = LABELS["outline"]
    attrs = {"long_name": label.long_name, "units": label.units}
    return xr.DataArray(outlines, dims=Dimension.MOTION, attrs=attrs)


def join_coordinates(batches: Sequence[Mapping[str, xr.Variable]]) -> dict[str, xr.Variable]:
    """Join the coordinates of several batches of ground motions."""
    return {
        name: xr.Variable((Dimension.MOTION,), np.concatenate([batch[name].values for batch in batches]))
        for name in batches[0]
    }
