"""Delay compensators and controllers that laboratories use, one per file."""

from reliab.simulation.compensators.adaptive_inverse import AdaptiveInverse
from reliab.simulation.compensators.adaptive_model_based import AdaptiveModelBased
from reliab.simulation.compensators.adaptive_time_series import AdaptiveTimeSeries
from reliab.simulation.compensators.feedforward import Feedforward
from reliab.simulation.compensators.inverse import InverseCompensation
from reliab.simulation.compensators.model_inverse import ModelInverse
from reliab.simulation.compensators.pi_phase_lead import PhaseLeadControl
from reliab.simulation.compensators.polynomial_extrapolation import PolynomialExtrapolation
from reliab.simulation.compensators.registry import compensators, find_compensator

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
