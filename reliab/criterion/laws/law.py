"""What every law of frequency and damping can do."""

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reliab.criterion.laws.validity import Validity

Limits = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Ellipse parameters a [-] and b [ms²]."""


class Law(ABC):
    """How the limits a and b depend on the structure.

    Attributes
    ----------
    name : str
        How the law is called on the command line.
    equation : str
        The law in the paper's notation.
    """

    name: ClassVar[str]
    equation: ClassVar[str]

    @property
    @abstractmethod
    def validity(self) -> Validity:
        """Where the law holds."""

    def limits(self, frequency: ArrayLike, damping_ratio: ArrayLike) -> Limits:
        """Limits of structures.

        Parameters
        ----------
        frequency : array_like
            Natural frequencies f [Hz].
        damping_ratio : array_like
            Damping ratios ξ [-], broadcast against the frequencies.

        Returns
        -------
        a, b : numpy.ndarray
            Ellipse parameters [-] and [ms²] in the broadcast shape.

        Raises
        ------
        InputError
            If a structure lies where the law does not hold.
        """
        self.validity.require(frequency, damping_ratio)
        f, xi = np.broadcast_arrays(
            np.asarray(frequency, dtype=np.float64), np.asarray(damping_ratio, dtype=np.float64)
        )
        a, b = self._limits(f, xi)
        return np.broadcast_to(a, f.shape), np.broadcast_to(b, f.shape)

    @abstractmethod
    def _limits(self, f: NDArray[np.float64], xi: NDArray[np.float64]) -> Limits:
        """Limits inside the validity; f and xi have one shape."""
