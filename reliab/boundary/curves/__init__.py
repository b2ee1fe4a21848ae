"""Curves that are fitted to a contour of equal error, one per file."""

from reliab.boundary.curves.cosine import Cosine
from reliab.boundary.curves.curve import Curve
from reliab.boundary.curves.ellipse import Ellipse
from reliab.boundary.curves.inscribed import InscribedEllipse
from reliab.boundary.curves.parabola import Parabola

__all__ = ["Cosine", "Curve", "Ellipse", "InscribedEllipse", "Parabola"]
