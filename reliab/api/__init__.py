"""What Python users and commands ask for: one function for each question, in one vocabulary."""

from reliab.lazy_exports import exports

_HOMES = {
    "assess": "reliab.api.assessment",
    "design_test": "reliab.api.design",
    "ellipses": "reliab.api.boundaries",
    "simulate": "reliab.api.simulation",
}

__all__ = ["assess", "design_test", "ellipses", "simulate"]

__getattr__ = exports(__name__, _HOMES)
