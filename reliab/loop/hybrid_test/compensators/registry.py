"""The library of compensators and controllers: those of this package and those that other packages add."""

from reliab.loop.hybrid_test.compensator import Compensator
from reliab.loop.hybrid_test.compensators.adaptive_inverse import AdaptiveInverse
from reliab.loop.hybrid_test.compensators.adaptive_model_based import AdaptiveModelBased
from reliab.loop.hybrid_test.compensators.adaptive_time_series import AdaptiveTimeSeries
from reliab.loop.hybrid_test.compensators.feedforward import Feedforward
from reliab.loop.hybrid_test.compensators.inverse import InverseCompensation
from reliab.loop.hybrid_test.compensators.model_inverse import ModelInverse
from reliab.loop.hybrid_test.compensators.pi_phase_lead import PhaseLeadControl
from reliab.loop.hybrid_test.compensators.polynomial_extrapolation import PolynomialExtrapolation
from reliab.registry import Registry

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

    Returns
    -------
    Registry of str to type
        The classes of compensators.

    Raises
    ------
    InputError
        When it is read: if another package adds something that is not a compensator, or a name that is
        already in use.

    Examples
    --------
    >>> "adaptive_time_series" in compensators()
    True
    """
    return _LIBRARY


def find_compensator(name: str) -> type[Compensator]:
    """Return the compensator of a name.

    Raises
    ------
    InputError
        If there is none; the message lists the known ones.
    """
    return _LIBRARY.find(name)
