"""Integration schemes that laboratories use, one per file."""

from reliab.loop.hybrid_test.integrators.central_difference import CentralDifference
from reliab.loop.hybrid_test.integrators.chen_ricles import ChenRicles
from reliab.loop.hybrid_test.integrators.coarse import CoarseExplicit
from reliab.loop.hybrid_test.integrators.operator_splitting import OperatorSplitting

__all__ = ["CentralDifference", "ChenRicles", "CoarseExplicit", "OperatorSplitting"]
