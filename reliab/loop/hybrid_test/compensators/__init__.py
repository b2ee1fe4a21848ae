"""Delay compensators and controllers that laboratories use, one per file."""

from reliab.loop.hybrid_test.compensators.adaptive_inverse import AdaptiveInverse
from reliab.loop.hybrid_test.compensators.adaptive_model_based import AdaptiveModelBased
from reliab.loop.hybrid_test.compensators.adaptive_time_series import AdaptiveTimeSeries
from reliab.loop.hybrid_test.compensators.feedforward import Feedforward
from reliab.loop.hybrid_test.compensators.inverse import InverseCompensation
from reliab.loop.hybrid_test.compensators.model_inverse import ModelInverse
from reliab.loop.hybrid_test.compensators.pi_phase_lead import PhaseLeadControl
from reliab.loop.hybrid_test.compensators.polynomial_extrapolation import PolynomialExtrapolation
from reliab.loop.hybrid_test.compensators.registry import compensators, find_compensator

__all__ = [
    "AdaptiveInverse",
    "AdaptiveModelBased",
    "AdaptiveTimeSeries",
    "Feedforward",
    "InverseCompensation",
    "ModelInverse",
    "PhaseLeadControl",
    "PolynomialExtrapolation",
    "compensators",
    "find_compensator",
]
