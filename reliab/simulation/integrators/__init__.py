"""Integration schemes that laboratories use, one per file."""

from reliab.simulation.integrators.central_difference import CentralDifference
from reliab.simulation.integrators.chen_ricles import ChenRicles
from reliab.simulation.integrators.coarse import CoarseExplicit
from reliab.simulation.integrators.operator_splitting import OperatorSplitting

__all__ = ["CentralDifference", "ChenRicles", "CoarseExplicit", "OperatorSplitting"]
