"""The library of compensators and controllers: those of this package and those that other packages add."""

from functools import cache
from importlib.metadata import entry_points

from reliab.errors import InputError
from reliab.loop.hybrid_test.compensator import Compensator
from reliab.loop.hybrid_test.compensators.adaptive_inverse import AdaptiveInverse
from reliab.loop.hybrid_test.compensators.adaptive_model_based import AdaptiveModelBased
from reliab.loop.hybrid_test.compensators.adaptive_time_series import AdaptiveTimeSeries
from reliab.loop.hybrid_test.compensators.feedforward import Feedforward
from reliab.loop.hybrid_test.compensators.inverse import InverseCompensation
from reliab.loop.hybrid_test.compensators.model_inverse import ModelInverse
from reliab.loop.hybrid_test.compensators.pi_phase_lead import PhaseLeadControl
from reliab.loop.hybrid_test.compensators.polynomial_extrapolation import PolynomialExtrapolation

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


@cache
def compensators() -> dict[str, type[Compensator]]:
    """All compensators by name.

    Returns
    -------
    dict of str to type
        The classes of compensators.

    Raises
    ------
    InputError
        If another package adds something that is no compensator, or a name that is taken.

    Examples
    --------
    >>> "adaptive_time_series" in compensators()
    True
    """
    known = {compensator.name: compensator for compensator in _SHIPPED}
    for entry in entry_points(group=ENTRY_POINT_GROUP):
        compensator = entry.load()
        if not (isinstance(compensator, type) and issubclass(compensator, Compensator)):
            raise InputError(
                f"What is registered under {ENTRY_POINT_GROUP} must be a class derived from Compensator",
                value=repr(compensator),
                remedy="Mend or remove the package that registers it",
                where=entry.value,
            )
        if compensator.name in known:
            raise InputError(
                "The name of a compensator must be unique",
                value=compensator.name,
                remedy="Rename the added compensator",
                where=entry.value,
            )
        known[compensator.name] = compensator
    return known


def find_compensator(name: str) -> type[Compensator]:
    """Return the compensator of a name.

    Raises
    ------
    InputError
        If there is none; the message lists those there are.
    """
    known = compensators()
    if name not in known:
        raise InputError(
            f"A compensator must be one of {', '.join(known)}", value=name, remedy="Choose one of these"
        )
    return known[name]
