from .adaptive_inverse import AdaptiveInverse as AdaptiveInverse
from .adaptive_model_based import AdaptiveModelBased as AdaptiveModelBased
from .adaptive_time_series import AdaptiveTimeSeries as AdaptiveTimeSeries
from .compensator import Compensator as Compensator
from .feedforward import Feedforward as Feedforward
from .inverse import InverseCompensation as InverseCompensation
from .model_inverse import ModelInverse as ModelInverse
from .pi_phase_lead import PhaseLeadControl as PhaseLeadControl
from .polynomial_extrapolation import PolynomialExtrapolation as PolynomialExtrapolation
from .registry import compensators as compensators, find_compensator as find_compensator
