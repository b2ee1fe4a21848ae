"""Curves fitted to a contour of equal error: ellipses, equations (7a) to (10)."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import MILLI, CurveName

if TYPE_CHECKING:
    from reliab.tracking.boundary.contour import Contour

_FEWEST_POINTS = 3


def fit_line(x: Array, y: Array) -> tuple[float, float]:
    """Slope and intercept of the least-squares straight line."""
    deviation = x - x.mean()
    slope = float(deviation @ y / (deviation @ deviation))
    return slope, float(y.mean() - slope * x.mean())


@dataclass(frozen=True, kw_only=True)
class Curve(ABC):
    """A curve d(A) of two parameters, fitted to a contour with the delay in milliseconds."""

    name: ClassVar[str]

    # a, b: Parameters; each curve defines their meaning and units
    a: float
    b: float
    sse: float  # Fitting error of equation (10), Σ(d̄² − d²)² [ms⁴]
    n: int  # Number of points of the contour

    @classmethod
    @abstractmethod
    def _parameters(cls, offset: Array, delay: Array) -> tuple[float, float]:
        """Parameters a and b that fit delays [ms] at amplitude offsets A − 1."""

    @classmethod
    @abstractmethod
    def _delay_squared(cls, offset: Array, a: float, b: float) -> Array:
        """Square of the delay [ms²] at amplitude offsets A − 1; negative outside the curve."""

    @classmethod
    def fit(cls, contour: "Contour") -> Self:
        """Fit the curve to a contour by least squares.

        `contour`: at least three points, or none where no actuator keeps the error below the threshold.
        Returns the curve with its fitting error; a = b = 0 for a contour without points. Raises InputError if
        there are one or two points.
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
        misfit = cls._delay_squared(offset, a, b) - delay**2
        return cls(a=a, b=b, sse=float(misfit @ misfit), n=offset.size)

    def delay(self, amplitude: Array) -> Array:
        """Delay on the curve [s] at given amplitudes [-]; NaN where the curve has no delay."""
        if self.n == 0:
            return np.full(np.shape(amplitude), np.nan)
        delay_squared = self._delay_squared(np.asarray(amplitude) - 1.0, self.a, self.b)
        return np.sqrt(np.where(delay_squared >= 0.0, delay_squared, np.nan)) / MILLI


@dataclass(frozen=True, kw_only=True)
class Ellipse(Curve):
    """Ellipse (A − 1)²/a + d²/b = 1 with its centre at the perfect actuator.

    Fitted as the straight line d² = b − (b/a)(A − 1)², equation (9), with a [-] and b [ms²].

    >>> from reliab.tracking.boundary.contour import Contour
    >>> angle = np.linspace(0.0, np.pi, 21)
    >>> circle = Contour(amplitude=1.0 + 0.01 * np.cos(angle), delay=0.002 * np.sin(angle))
    >>> found = Ellipse.fit(circle)
    >>> round(found.a, 8), round(found.b, 8)
    (0.0001, 4.0)
    """

    name: ClassVar[CurveName] = CurveName.ELLIPSE

    @classmethod
    def _parameters(cls, offset: Array, delay: Array) -> tuple[float, float]:
        slope, intercept = fit_line(offset**2, delay**2)
        return -intercept / slope, intercept

    @classmethod
    def _delay_squared(cls, offset: Array, a: float, b: float) -> Array:
        return b - (b / a) * offset**2


@dataclass(frozen=True, kw_only=True)
class InscribedEllipse(Ellipse):
    """Ellipse (A − 1)²/a + d²/b = 1 of the largest area that contains no point of the boundary.

    In the plane of (A − 1)² and d² an ellipse is a straight line, and the points of the boundary are to lie
    above it. The area is largest for a line along an edge of their lower convex hull, of which the tips of
    the boundary, on d = 0, are part; so comparing these few edges gives the exact result. Where the boundary
    is cut (in amplitude) or open (towards leads), the ellipse ends where the tracing of the boundary ended.

    >>> from reliab.tracking.boundary.contour import Contour
    >>> offset = np.linspace(-0.01, 0.01, 21)
    >>> roof = Contour(amplitude=1.0 + offset, delay=0.002 * (1.0 - np.abs(offset) / 0.01))
    >>> inside, fitted = InscribedEllipse.fit(roof), Ellipse.fit(roof)
    >>> not (inside.delay(roof.amplitude) > roof.delay + 1e-12).any()
    True
    >>> inside.a < fitted.a
    True
    """

    name: ClassVar[CurveName] = CurveName.INSCRIBED

    @classmethod
    def fit(cls, contour: "Contour") -> Self:
        """Inscribe the ellipse in a boundary.

        `contour`: one side of a boundary. Returns the ellipse, with the misfit of equation (10) at the points
        of the boundary; a = b = 0 where there is neither a point nor a corner, because no actuator keeps the
        error below the threshold.
        """
        amplitude, delay = contour.outline
        if amplitude.size == 0:
            return cls(a=0.0, b=0.0, sse=0.0, n=0)
        offset = amplitude - 1.0
        width = min(-float(offset.min()), float(offset.max()))
        squares = np.stack([np.append(offset**2, width**2), np.append((MILLI * delay) ** 2, 0.0)])
        a, b = _largest_below(_lower_hull(squares))
        misfit = cls._delay_squared(contour.amplitude - 1.0, a, b) - (MILLI * contour.delay) ** 2
        return cls(a=a, b=b, sse=float(misfit @ misfit), n=contour.amplitude.size)


def _lower_hull(points: Array) -> Array:
    """Take the lower left convex hull of points, falling from left to right; shape (2, n)."""
    order = np.lexsort((points[1], points[0]))
    hull: list[tuple[float, float]] = []
    for x, y in zip(*(row.tolist() for row in points[:, order]), strict=True):
        if hull and y >= hull[-1][1]:
            continue
        while len(hull) > 1 and _turns_up(hull[-2], hull[-1], (x, y)):
            hull.pop()
        hull.append((x, y))
    return np.array(hull, dtype=np.float64).T


def _turns_up(first: tuple[float, float], middle: tuple[float, float], last: tuple[float, float]) -> bool:
    """Tell whether the middle point lies on or above the line between its neighbours."""
    (x0, y0), (x1, y1), (x2, y2) = first, middle, last
    return (y1 - y0) * (x2 - x0) >= (y2 - y0) * (x1 - x0)


def _largest_below(hull: Array) -> tuple[float, float]:
    """Find where the line along an edge of the hull that spans the largest area meets the axes."""
    (x0, x1), (y0, y1) = ((row[:-1], row[1:]) for row in hull)
    fall = (y0 - y1) / (x1 - x0)
    b = y0 + fall * x0
    a = b / fall
    best = int(np.argmax(a * b))
    return float(a[best]), float(b[best])
