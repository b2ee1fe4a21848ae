"""Checks of what is asked of stored ellipses and results."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr


def require_column(
    dataset: "xr.Dataset", name: str, wanted: "list[float] | list[str] | None", path: Path
) -> None:
    """Refuse to relabel a table that is of one structure and error.

    Parameters
    ----------
    dataset : xarray.Dataset
        The table.
    name : str
        A column, f for example.
    wanted : list or None
        Values that are asked for.
    path : pathlib.Path
        File of the table.

    Raises
    ------
    InputError
        If the table is of another value.
    """
    import numpy as np

    held = dataset[name].values
    numeric = held.dtype.kind == "f"
    for value in wanted or []:
        known = np.isclose(held, value, rtol=1e-9).any() if numeric else value in held.tolist()
        if not known and held.size == 1:
            raise InputError(
                f"A table of ellipses holds only for the {name} with which the ellipses were traced",
                value=f"{value} for {path.name}, whose {name} is {held[0]}",
                remedy=(
                    f"Leave --{name} out, or add the column {name} to the table if its "
                    f"ellipses are of another"
                ),
                where=str(path),
            )


def of_fraction(dataset: "xr.Dataset", alpha: float | None, path: Path) -> "xr.Dataset":
    """Carry stored boundaries of α = 1 to a smaller share; refuse any other change of it.

    Parameters
    ----------
    dataset : xarray.Dataset
        The boundaries.
    alpha : float or None
        Fraction that is asked for [-].
    path : pathlib.Path
        File or store of the boundaries.

    Returns
    -------
    xarray.Dataset
        The boundaries, with a caution where they were carried.

    Raises
    ------
    InputError
        If they were computed with another fraction than 1, do not state it, or the law that carries them does
        not hold.
    """
    stated = dataset.attrs.get("experimental_fraction")
    stored = 1.0 if stated is None else float(stated)
    if alpha is None or math.isclose(alpha, stored, rel_tol=1e-9):
        return dataset
    if stated is None or stored != 1.0:
        raise InputError(
            "The experimental fraction is that with which the boundaries were computed",
            value=f"--alpha {alpha:g}, where it is {stored:g}",
            remedy="Leave --alpha out, or give --motions, whose boundaries are computed for any fraction",
            where=str(path),
        )
    from reliab.criterion.experimental_share import carry_to_share

    return carry_to_share(dataset, alpha)


def among(dataset: "xr.Dataset", f: list[float] | None, xi: list[float] | None) -> "xr.Dataset":
    """Keep the structures that are asked for, or all where one of them lies between the stored ones.

    Parameters
    ----------
    dataset : xarray.Dataset
        Boundaries or results over f and xi.
    f, xi : list of float or None
        Structures that are asked for [Hz, -].

    Returns
    -------
    xarray.Dataset
        What is kept.
    """
    import numpy as np

    for name, wanted in (("f", f), ("xi", xi)):
        held = dataset[name].values
        if wanted and all(np.isclose(held, value, rtol=1e-9).any() for value in wanted):
            dataset = dataset.sel({name: wanted}, method="nearest")
    return dataset
