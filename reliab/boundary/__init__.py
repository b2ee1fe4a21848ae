"""Contours of equal error and the curves that stand for them."""

from reliab.boundary.contour import Contour, trace_contours
from reliab.boundary.curves import Cosine, Curve, Ellipse, InscribedEllipse, Parabola
from reliab.boundary.motion_boundary import motion_contours
from reliab.boundary.suite_boundary import suite_contours

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
