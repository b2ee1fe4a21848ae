"""The library of compensators and controllers: those of this package and those that other packages add."""

from reliab.core.registry import Registry
from reliab.simulation.compensators.adaptive_inverse import AdaptiveInverse
from reliab.simulation.compensators.adaptive_model_based import AdaptiveModelBased
from reliab.simulation.compensators.adaptive_time_series import AdaptiveTimeSeries
from reliab.simulation.compensators.compensator import Compensator
from reliab.simulation.compensators.feedforward import Feedforward
from reliab.simulation.compensators.inverse import InverseCompensation
from reliab.simulation.compensators.model_inverse import ModelInverse
from reliab.simulation.compensators.pi_phase_lead import PhaseLeadControl
from reliab.simulation.compensators.polynomial_extrapolation import PolynomialExtrapolation

ENTRY_POINT_GROUP = "reliab.compensators"
"""Group under which other packages register classes derived from `Compensator`."""

_SHIPPED: tuple[type[Compensator], ...] = (
    PhaseLeadControl,
    Feedforward,
    InverseCompensation,
    PolynomialExtrapolation,
    ModelInverse,
    AdaptiveInverse,
    AdaptiveTimeSeries,
    AdaptiveModelBased,
)


_LIBRARY: Registry[type[Compensator]] = Registry(
    noun="compensator",
    base=Compensator,
    group=ENTRY_POINT_GROUP,
    shipped=_SHIPPED,
    name_of=lambda compensator: compensator.name,
)


def compensators() -> Registry[type[Compensator]]:
    """All compensators by name.

    >>> "adaptive_time_series" in compensators()
    True
    """
    return _LIBRARY
