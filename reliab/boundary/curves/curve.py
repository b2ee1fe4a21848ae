"""Base class of the curves that are fitted to a contour of equal error."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from reliab.boundary.contour import Contour
from reliab.errors import InputError
from reliab.vocabulary import MILLI, CurveName

_FEWEST_POINTS = 3


def fit_line(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float]:
    """Slope and intercept of the least-squares straight line."""
    centred = x - x.mean()
    slope = float(centred @ y / (centred @ centred))
    return slope, float(y.mean() - slope * x.mean())


@dataclass(frozen=True, kw_only=True)
class Curve(ABC):
    """A curve d(A) of two parameters, fitted to a contour with the delay in milliseconds.

    Attributes
    ----------
    a, b : float
        Parameters; each curve defines their meaning and units.
    sse : float
        Fitting error of equation (10), Σ(d̄² − d²)² [ms⁴].
    n : int
        Number of points of the contour.
    """

    name: ClassVar[CurveName]
    equation: ClassVar[str]

    a: float
    b: float
    sse: float
    n: int

    @classmethod
    @abstractmethod
    def _parameters(cls, offset: NDArray[np.float64], delay: NDArray[np.float64]) -> tuple[float, float]:
        """Parameters a and b that fit delays [ms] at amplitude offsets A − 1."""

    @classmethod
    @abstractmethod
    def _squared_delay(cls, offset: NDArray[np.float64], a: float, b: float) -> NDArray[np.float64]:
        """Square of the delay [ms²] at amplitude offsets A − 1; negative outside the curve."""

    @classmethod
    def fit(cls, contour: Contour) -> Self:
        """Fit the curve to a contour by least squares.

        Parameters
        ----------
        contour : Contour
            At least three points, or none where no actuator keeps the error below the threshold.

        Returns
        -------
        Curve
            The curve with its fitting error; a = b = 0 for a contour without points.

        Raises
        ------
        InputError
            If there are one or two points.
        """
        if contour.amplitude.size == 0:
            return cls(a=0.0, b=0.0, sse=0.0, n=0)
        if contour.amplitude.size < _FEWEST_POINTS:
            raise InputError(
                f"A curve is fitted to at least {_FEWEST_POINTS} points of a contour",
                value=contour.amplitude.size,
                remedy="Sample the contour more finely",
            )
        offset, delay = contour.amplitude - 1.0, MILLI * contour.delay
        a, b = cls._parameters(offset, delay)
        misfit = cls._squared_delay(offset, a, b) - delay**2
        return cls(a=a, b=b, sse=float(misfit @ misfit), n=offset.size)

    def delay(self, amplitude: NDArray[np.float64]) -> NDArray[np.float64]:
        """Delay on the curve [s] at given amplitudes [-]; NaN where the curve has no delay."""
        if self.n == 0:
            return np.full(np.shape(amplitude), np.nan)
        squared = self._squared_delay(np.asarray(amplitude) - 1.0, self.a, self.b)
        return np.sqrt(np.where(squared >= 0.0, squared, np.nan)) / MILLI
