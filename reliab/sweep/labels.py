"""Names, units and data on ground motions that every dataset carries; shares of the stiffness.

A dataset of one share, as every version wrote it, names it in its attribute `experimental_fraction`. One of
several shares has the dimension `alpha` after `xi`, and no such attribute; `select_share` cuts one share out
of it, which is then like any dataset of one share.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import xarray as xr

from reliab.core.errors import InputError
from reliab.core.progress import Progress
from reliab.core.vocabulary import LABELS, SHARE_ATTRIBUTE, Dimension
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
    outlines = np.array(
        [outline_of(motion.acceleration, motion.time_step) for motion in motions], dtype=np.str_
    )
    label = LABELS["outline"]
    attrs = {"long_name": label.long_name, "units": label.units}
    return xr.DataArray(outlines, dims=Dimension.MOTION, attrs=attrs)


def join_coordinates(batches: Sequence[Mapping[str, xr.Variable]]) -> dict[str, xr.Variable]:
    """Join the coordinates of several batches of ground motions."""
    return {
        name: xr.Variable((Dimension.MOTION,), np.concatenate([batch[name].values for batch in batches]))
        for name in batches[0]
    }


_FULL_SHARE = 1.0


def shares_of(dataset: xr.Dataset) -> tuple[float, ...]:
    """Shares of the stiffness in the laboratory that a dataset is of.

    Returns shares [-]; the whole stiffness where the dataset does not state one.

    >>> shares_of(xr.Dataset(attrs={"experimental_fraction": 0.5}))
    (0.5,)
    >>> shares_of(xr.Dataset(coords={"alpha": [0.25, 1.0]}))
    (0.25, 1.0)
    """
    if Dimension.SHARE in dataset.coords:
        return tuple(float(share) for share in np.atleast_1d(dataset[Dimension.SHARE].values))
    return (float(dataset.attrs.get(SHARE_ATTRIBUTE, _FULL_SHARE)),)


def share_of(dataset: xr.Dataset) -> float:
    """Share of the stiffness in the laboratory of a dataset of one share.

    Returns share [-]; 1 where the dataset does not state one. Raises InputError if the dataset is of several
    shares.
    """
    shares = shares_of(dataset)
    if len(shares) > 1:
        raise InputError(
            "This needs a dataset of one share of the stiffness in the laboratory",
            value=f"a dataset of α = {_list_shares(shares)}",
            remedy="Choose one with reliab.sweep.labels.select_share, or as `alpha` of a command",
        )
    return shares[0]


def select_share(dataset: xr.Dataset, share: float | None = None) -> xr.Dataset:
    """Cut one share of the stiffness out of a dataset.

    `dataset`: results or ellipses of one share or several.
    `share`: share [-], one of the dataset's; may be left out where there is only one.
    Returns without the dimension `alpha`, with the share in the attribute `experimental_fraction`.
    Raises InputError if the dataset is not of that share, or is of several and none is given.

    >>> several = xr.Dataset({"a": ("alpha", [4e-4, 1e-4])}, coords={"alpha": [0.5, 1.0]})
    >>> float(select_share(several, 0.5)["a"]), select_share(several, 0.5).attrs
    (0.0004, {'experimental_fraction': 0.5})
    """
    shares = shares_of(dataset)
    requested_share = share_of(dataset) if share is None else share
    near = [place for place, value in enumerate(shares) if np.isclose(requested_share, value, rtol=1e-9)]
    if not near:
        raise InputError(
            "The dataset has no such share of the stiffness",
            value=f"α = {requested_share:g}; it has α = {_list_shares(shares)}",
            remedy="Choose one of these, or simulate that one",
        )
    if Dimension.SHARE not in dataset.coords:
        return dataset
    if Dimension.SHARE in dataset.dims:
        dataset = dataset.isel({Dimension.SHARE: near[0]})
    return dataset.drop_vars(Dimension.SHARE).assign_attrs({SHARE_ATTRIBUTE: shares[near[0]]})


def concatenate_shares(
    shares: Sequence[float], compute: Callable[[float, Progress], xr.Dataset], progress: Progress
) -> xr.Dataset:
    """Compute a dataset of each share and join them along `alpha`.

    `shares`: shares of the stiffness in the laboratory [-]; `compute`: takes a share and a progress, returns
    a dataset of that share; `progress`: called with the steps done for all shares and their number. Returns
    of one share what was computed, unchanged; of several with the dimension `alpha` after `xi`.
    """
    datasets = []
    for turn, share in enumerate(shares):

        def advance(step: int, total: int, turn: int = turn) -> None:
            progress(turn * total + step, len(shares) * total)

        datasets.append(compute(share, advance))
    if len(datasets) == 1:
        return datasets[0]
    dataset = xr.concat(
        datasets,
        xr.DataArray(list(shares), dims=Dimension.SHARE, name=str(Dimension.SHARE)),
        data_vars="all",
        coords="minimal",
        compat="override",
        join="exact",
        combine_attrs="override",
    )
    dataset.attrs.pop(SHARE_ATTRIBUTE, None)
    cautions = dict.fromkeys(dataset.attrs["caution"] for dataset in datasets if "caution" in dataset.attrs)
    if cautions:
        dataset.attrs["caution"] = " ".join(cautions)
    return label_variables(dataset.map(_order_share_dimension, keep_attrs=True))


def _list_shares(shares: Sequence[float]) -> str:
    return ", ".join(f"{share:g}" for share in shares)


def _order_share_dimension(values: xr.DataArray) -> xr.DataArray:
    """Move the dimension of the share behind that of the damping ratio."""
    if Dimension.SHARE not in values.dims:
        return values
    names = [name for name in values.dims if name != Dimension.SHARE]
    names.insert(names.index(Dimension.DAMPING_RATIO) + 1, Dimension.SHARE)
    return values.transpose(*names)
