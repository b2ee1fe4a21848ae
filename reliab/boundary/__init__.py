"""Contours of equal error and the curves that stand for them; what simulates is imported on first use."""

from typing import TYPE_CHECKING

from reliab.boundary.contour import Contour, trace_contours
from reliab.boundary.curves import Cosine, Curve, Ellipse, InscribedEllipse, Parabola
from reliab.lazy_exports import exports

if TYPE_CHECKING:
    from reliab.boundary.motion_boundary import motion_contours
    from reliab.boundary.suite_boundary import suite_contours

_HOMES = {
    "motion_contours": "reliab.boundary.motion_boundary",
    "suite_contours": "reliab.boundary.suite_boundary",
}

__all__ = [
    "Contour",
    "Cosine",
    "Curve",
    "Ellipse",
    "InscribedEllipse",
    "Parabola",
    "motion_contours",
    "suite_contours",
    "trace_contours",
]

__getattr__ = exports(__name__, _HOMES)
