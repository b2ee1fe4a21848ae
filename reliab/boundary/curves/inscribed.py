"""The largest ellipse that lies wholly inside a boundary."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from reliab.boundary.contour import Contour
from reliab.boundary.curves.ellipse import Ellipse
from reliab.vocabulary import MILLI, CurveName


@dataclass(frozen=True, kw_only=True)
class InscribedEllipse(Ellipse):
    """Ellipse (A − 1)²/a + d²/b = 1 of the largest area that contains no point of the boundary.

    In the plane of (A − 1)² and d² an ellipse is a straight line, and the points of the boundary are to lie
    above it. The area is largest for a line along an edge of their lower convex hull, of which the tips of
    the boundary, on d = 0, are part; so comparing these few edges gives the exact result. Where the boundary
    is cut (in amplitude) or open (towards leads), the ellipse ends where the tracing of the boundary ended.

    Examples
    --------
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
    def fit(cls, contour: Contour) -> Self:
        """Inscribe the ellipse in a boundary.

        Parameters
        ----------
        contour : Contour
            One side of a boundary.

        Returns
        -------
        InscribedEllipse
            The ellipse, with the misfit of equation (10) at the points of the boundary; a = b = 0
            where there is neither a point nor a corner, because no actuator keeps the error below the
            threshold.
        """
        amplitude, delay = contour.outline
        if amplitude.size == 0:
            return cls(a=0.0, b=0.0, sse=0.0, n=0)
        offset = amplitude - 1.0
        width = min(-float(offset.min()), float(offset.max()))
        squares = np.stack([np.append(offset**2, width**2), np.append((MILLI * delay) ** 2, 0.0)])
        a, b = _largest_below(_lower_hull(squares))
        misfit = cls._squared_delay(contour.amplitude - 1.0, a, b) - (MILLI * contour.delay) ** 2
        return cls(a=a, b=b, sse=float(misfit @ misfit), n=contour.amplitude.size)


def _lower_hull(points: NDArray[np.float64]) -> NDArray[np.float64]:
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


def _largest_below(hull: NDArray[np.float64]) -> tuple[float, float]:
    """Find where the line along an edge of the hull that spans the largest area meets the axes."""
    (x0, x1), (y0, y1) = ((row[:-1], row[1:]) for row in hull)
    fall = (y0 - y1) / (x1 - x0)
    b = y0 + fall * x0
    a = b / fall
    best = int(np.argmax(a * b))
    return float(a[best]), float(b[best])
