"""Which file of shipped results holds given structures: the small one of six, or that of all 72."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from reliab.shipped import or_shipped, shipped

REAL: Final = "real_suite"
"""Name of the results and ellipses of 100 real ground motions that ship."""

_OF_SIX, _OF_ALL = f"{REAL}/results_of_six.nc", f"{REAL}/results.nc"
_SIX: Final = ((0.5, 1.0, 2.0), (0.02, 0.05))


def real_results(f: Sequence[float] | None, xi: Sequence[float] | None) -> Path:
    """Find the results of the real motions for structures.

    Parameters
    ----------
    f, xi : sequence of float or None
        Natural frequencies [Hz] and damping ratios [-]; None for all that were simulated.

    Returns
    -------
    pathlib.Path
        The smallest file that holds them; the values in both are the same.

    Raises
    ------
    InputError
        If only the file of all structures holds them, and it was not fetched.

    Examples
    --------
    >>> real_results([1.0, 2.0], [0.05]).name
    'results_of_six.nc'
    """
    held = all(
        wanted is not None and all(np.isclose(nodes, value, rtol=1e-9).any() for value in wanted)
        for nodes, wanted in zip(_SIX, (f, xi), strict=True)
    )
    return shipped("datasets", _OF_SIX if held else _OF_ALL)


def stored_results(path: Path, f: Sequence[float] | None, xi: Sequence[float] | None) -> Path:
    """Take a store of results as it is, or the results of the real motions by their name.

    Parameters
    ----------
    path : pathlib.Path
        A store, or "real_suite".
    f, xi : sequence of float or None
        Structures that are asked for [Hz, -]; None for all.

    Returns
    -------
    pathlib.Path
        The store.
    """
    named = path == Path(REAL) and not path.exists()
    return real_results(f, xi) if named else or_shipped(path, "datasets", "results.nc")
