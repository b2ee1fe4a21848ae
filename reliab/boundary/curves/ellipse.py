"""Ellipse, equations (7a), (8) and (9)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.boundary.curves.curve import Curve, fit_line
from reliab.vocabulary import CurveName


@dataclass(frozen=True, kw_only=True)
class Ellipse(Curve):
    """Ellipse (A − 1)²/a + d²/b = 1 with its centre at the perfect actuator.

    Fitted as the straight line d² = b − (b/a)(A − 1)², equation (9), with a [-] and b [ms²].

    Examples
    --------
    >>> from reliab.boundary.contour import Contour
    >>> angle = np.linspace(0.0, np.pi, 21)
    >>> circle = Contour(amplitude=1.0 + 0.01 * np.cos(angle), delay=0.002 * np.sin(angle))
    >>> found = Ellipse.fit(circle)
    >>> round(found.a, 8), round(found.b, 8)
    (0.0001, 4.0)
    """

    name: ClassVar[CurveName] = CurveName.ELLIPSE
    equation: ClassVar[str] = "(A − 1)²/a + d²/b = 1"

    @classmethod
    def _parameters(cls, offset: NDArray[np.float64], delay: NDArray[np.float64]) -> tuple[float, float]:
        slope, intercept = fit_line(offset**2, delay**2)
        return -intercept / slope, intercept

    @classmethod
    def _squared_delay(cls, offset: NDArray[np.float64], a: float, b: float) -> NDArray[np.float64]:
        return b - (b / a) * offset**2
