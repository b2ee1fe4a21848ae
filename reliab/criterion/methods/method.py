"""What a stated confidence can mean: the interface of every method."""

from abc import ABC, abstractmethod
from dataclasses import asdict
from typing import Any, ClassVar, cast

import numpy as np
from numpy.typing import NDArray

from reliab.errors import InputError


class Method(ABC):
    """A lower bound on a quantity over ground motions.

    A criterion is safe when it is small: at a confidence of 95 % it is a bound that 95 % of the
    motions exceed, the paper's 5 % quantile. How this is meant is the method's definition.

    Attributes
    ----------
    name : str
        How the method is called on the command line.
    exchangeable : str
        What has to be interchangeable for the method to keep its promise.
    """

    name: ClassVar[str]
    exchangeable: ClassVar[str]

    @property
    def assumes_lognormality(self) -> bool:
        """Whether the promise needs lognormal motions."""
        return False

    @property
    def settings(self) -> dict[str, Any]:
        """Parameters of the method, ready for JSON."""
        return asdict(cast("Any", self))

    def lower_bound(
        self, logarithms: NDArray[np.float64], events: NDArray[np.str_], confidence: float
    ) -> float:
        """Bound that the stated share of the motions exceeds.

        Parameters
        ----------
        logarithms : array of float, shape (motions,)
            Logarithms of the quantity.
        events : array of str, shape (motions,)
            Earthquake of each motion.
        confidence : float
            Stated share of the motions, in (0, 1).

        Returns
        -------
        float
            Logarithm of the bound; minus infinity when the motions are too few for the promise.

        Raises
        ------
        InputError
            If the confidence lies outside of (0, 1).
        """
        return self._lower_bound(logarithms, events, checked_share(confidence, "confidence"))

    @abstractmethod
    def _lower_bound(
        self, logarithms: NDArray[np.float64], events: NDArray[np.str_], confidence: float
    ) -> float:
        """Bound for a checked confidence."""


def checked_share(share: float, what: str) -> float:
    """Return a share between 0 and 1 (both excluded), or say what is wrong with it."""
    if not 0.0 < share < 1.0:
        raise InputError(
            f"The {what} must lie between 0 and 1",
            value=share,
            remedy="Give a fraction, 0.95 for 95 %",
        )
    return float(share)
