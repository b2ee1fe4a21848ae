"""What every law of frequency and damping can do."""

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reliab.criterion.laws.checks import checked_limits
from reliab.criterion.laws.validity import Validity

Limits = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Ellipse parameters a [-] and b [ms²]."""


class Law(ABC):
    """How the limits a and b depend on the structure."""

    name: ClassVar[str]  # How the law is called on the command line
    equation: ClassVar[str]  # The law in the paper's notation
    # Whether the law, as it is printed, holds for delays of either sign
    counts_leads_as_lags: ClassVar[bool] = False

    @property
    @abstractmethod
    def validity(self) -> Validity:
        """Where the law holds."""

    def limits(self, frequency: ArrayLike, damping_ratio: ArrayLike) -> Limits:
        """Limits of structures.

        `frequency` [Hz]; `damping_ratio` [-].
        """
        self.validity.require(frequency, damping_ratio)
        f, xi = np.broadcast_arrays(
            np.asarray(frequency, dtype=np.float64), np.asarray(damping_ratio, dtype=np.float64)
        )
        a, b = self._limits(f, xi)
        return (
            checked_limits("a", np.broadcast_to(a, f.shape), f.shape),
            checked_limits("b", np.broadcast_to(b, f.shape), f.shape),
        )

    @abstractmethod
    def _limits(self, f: NDArray[np.float64], xi: NDArray[np.float64]) -> Limits:
        """Limits inside the validity; f and xi have one shape."""
