"""Checks of what is asked of stored ellipses and results."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

_WHOLE = 1.0


def require_column(
    dataset: "xr.Dataset", name: str, wanted: "list[float] | list[str] | None", path: Path
) -> None:
    """Refuse to relabel a table that is of one structure and error."""
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


def of_fractions(dataset: "xr.Dataset", alpha: list[float] | None, path: Path) -> "xr.Dataset":
    """Choose shares of the stiffness among stored boundaries, or carry those of α = 1 to a smaller share.

    `alpha` [-].
    """
    from reliab.progress import silent
    from reliab.sweep import for_each_share

    if alpha is None:
        return dataset
    return for_each_share(sorted(set(alpha)), lambda share, _: _of_fraction(dataset, share, path), silent)


def _of_fraction(dataset: "xr.Dataset", alpha: float, path: Path) -> "xr.Dataset":
    """Choose one share, or carry the boundaries of α = 1 to it."""
    from reliab.criterion import carry_to_share
    from reliab.sweep import at_share, shares_of
    from reliab.vocabulary import SHARE_ATTRIBUTE

    shares = shares_of(dataset)
    if _near(alpha, shares):
        return at_share(dataset, alpha)
    stated = "alpha" in dataset.coords or SHARE_ATTRIBUTE in dataset.attrs
    if not stated or not _near(_WHOLE, shares):
        raise InputError(
            "The experimental fraction is that with which the boundaries were computed",
            value=f"--alpha {alpha:g}, where it is {', '.join(f'{share:g}' for share in shares)}",
            remedy="Leave --alpha out, or give --motions, whose boundaries are computed for any fraction",
            where=str(path),
        )
    return carry_to_share(at_share(dataset, _WHOLE), alpha)


def _near(alpha: float, shares: tuple[float, ...]) -> bool:
    return any(math.isclose(alpha, share, rel_tol=1e-9) for share in shares)


def among(dataset: "xr.Dataset", f: list[float] | None, xi: list[float] | None) -> "xr.Dataset":
    """Keep the structures that are asked for, or all where one of them lies between the stored ones.

    `f`, `xi` [Hz, -].
    """
    import numpy as np

    for name, wanted in (("f", f), ("xi", xi)):
        held = dataset[name].values
        if wanted and all(np.isclose(held, value, rtol=1e-9).any() for value in wanted):
            dataset = dataset.sel({name: wanted}, method="nearest")
    return dataset
