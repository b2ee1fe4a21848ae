"""Parabola, equation (7c)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.boundary.curves.curve import Curve, fit_line
from reliab.vocabulary import CurveName


@dataclass(frozen=True, kw_only=True)
class Parabola(Curve):
    """Parabola d = a(A − 1)² + b with a and b [ms], equation (7c)."""

    name: ClassVar[CurveName] = CurveName.PARABOLA
    equation: ClassVar[str] = "d = a(A − 1)² + b"

    @classmethod
    def _parameters(cls, offset: NDArray[np.float64], delay: NDArray[np.float64]) -> tuple[float, float]:
        return fit_line(offset**2, delay)

    @classmethod
    def _squared_delay(cls, offset: NDArray[np.float64], a: float, b: float) -> NDArray[np.float64]:
        return np.asarray((a * offset**2 + b) ** 2)
