"""Random numbers whose bytes do not depend on the version of NumPy."""

from typing import Final

import numpy as np
import scipy

from reliab.core.arrays import Array

_DISCARDED_BITS: Final = np.uint64(11)
_RESOLUTION: Final = 2.0**-53


class RandomStream:
    """Independent uniform and normal numbers for one purpose, found by a seed and a key.

    NumPy promises the bits of a bit generator for ever, but not what ``Generator.normal`` makes of them.
    The stream therefore takes the bits themselves: 53 of each 64 become a uniform number, and the inverse
    normal distribution makes it a normal one.

    >>> RandomStream(2017, 1).uniforms(2)
    array([0.37796854, 0.26692428])
    """

    def __init__(self, seed: int, *key: int) -> None:
        self._bits = np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key))

    def uniforms(self, count: int) -> Array:
        """Draw numbers uniform in the open interval (0, 1), shape (count,)."""
        raw = np.asarray(self._bits.random_raw(count))
        return ((raw >> _DISCARDED_BITS).astype(np.float64) + 0.5) * _RESOLUTION

    def normals(self, count: int) -> Array:
        """Draw standard normal numbers, shape (count,)."""
        normals: Array = scipy.special.ndtri(self.uniforms(count))
        return normals

    def uniform(self) -> float:
        """Draw one number uniform in the open interval (0, 1)."""
        return float(self.uniforms(1)[0])
