"""Delay compensators that laboratories use, one per file."""

from reliab.loop.hybrid_test.compensators.feedforward import Feedforward
from reliab.loop.hybrid_test.compensators.inverse import InverseCompensation
from reliab.loop.hybrid_test.compensators.polynomial_extrapolation import PolynomialExtrapolation

__all__ = ["Feedforward", "InverseCompensation", "PolynomialExtrapolation"]
