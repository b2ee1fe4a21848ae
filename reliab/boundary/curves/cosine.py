"""Cosine, equation (7b)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.boundary.curves.curve import Curve
from reliab.vocabulary import CurveName


@dataclass(frozen=True, kw_only=True)
class Cosine(Curve):
    """Cosine d = a cos(b(A − 1)) with a [ms] and b [rad], equation (7b)."""

    name: ClassVar[CurveName] = CurveName.COSINE
    equation: ClassVar[str] = "d = a cos(b(A − 1))"

    @classmethod
    def _parameters(cls, offset: NDArray[np.float64], delay: NDArray[np.float64]) -> tuple[float, float]:
        guess = (float(delay.max()), 0.5 * np.pi / float(np.abs(offset).max()))
        (a, b), _ = scipy.optimize.curve_fit(lambda x, a, b: a * np.cos(b * x), offset, delay, p0=guess)
        return float(a), float(b)

    @classmethod
    def _squared_delay(cls, offset: NDArray[np.float64], a: float, b: float) -> NDArray[np.float64]:
        return np.asarray((a * np.cos(b * offset)) ** 2)
