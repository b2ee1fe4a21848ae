"""Shear frames: rigid floors on springs, described from the ground up."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reliab.errors import InputError


def shear_frame(
    masses: Sequence[float], storey_stiffnesses: Sequence[float]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mass and stiffness matrices of a shear frame.

    `masses` [kg]; `storey_stiffnesses` [N/m].
    Returns M [kg] and K [N/m] for the horizontal displacements of the floors, shape (storeys, storeys).

    >>> mass, stiffness = shear_frame([1000.0, 1000.0], [2e6, 1e6])
    >>> stiffness
    array([[ 3000000., -1000000.],
           [-1000000.,  1000000.]])
    """
    m, k = np.asarray(masses, dtype=np.float64), np.asarray(storey_stiffnesses, dtype=np.float64)
    if m.size != k.size or m.size == 0:
        raise InputError(
            "A shear frame needs as many floor masses as storey stiffnesses",
            value=f"{m.size} masses and {k.size} stiffnesses",
        )
    if not ((m > 0.0) & np.isfinite(m)).all() or not ((k > 0.0) & np.isfinite(k)).all():
        raise InputError(
            "Masses and stiffnesses of storeys must be positive and finite",
            value=f"masses {m.tolist()} and stiffnesses {k.tolist()}",
        )
    above = np.append(k[1:], 0.0)
    return np.diag(m), np.diag(k + above) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
