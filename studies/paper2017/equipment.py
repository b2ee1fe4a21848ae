"""Integrators and compensators with which the paper's cases can be run, the paper's own first."""

from collections.abc import Callable, Mapping
from typing import Final, TypeVar

from reliab.errors import InputError
from reliab.simulation.compensators import (
    Compensator,
    Feedforward,
    InverseCompensation,
    PolynomialExtrapolation,
)
from reliab.simulation.integrators import (
    CentralDifference,
    ChenRicles,
    ExactIntegrator,
    Integrator,
    OperatorSplitting,
)
from reliab.structures import Structure

from .printed import RATE_HZ

Maker = TypeVar("Maker")

INTEGRATORS: Final[Mapping[str, Callable[[Structure], Integrator]]] = {
    "chen_ricles": lambda structure: ChenRicles(structure=structure),
    "central_difference": lambda _: CentralDifference(),
    "operator_splitting": lambda structure: OperatorSplitting(structure=structure),
    "exact": lambda _: ExactIntegrator(),
}
"""Integrators by name; each takes the structure of a case."""

COMPENSATORS: Final[Mapping[str, Callable[[float], Compensator | None]]] = {
    "inverse": lambda steps: InverseCompensation(steps=steps),
    "feedforward": lambda steps: Feedforward(time=(steps - 1.0) / RATE_HZ),
    "polynomial_extrapolation": lambda steps: PolynomialExtrapolation(steps=max(1, round(steps - 1.0))),
    "none": lambda _: None,
}
"""Compensators by name; each takes the delay that the case estimates [steps], counted from when the command
is sent, one step before it is due."""


def integrator_of(name: str, structure: Structure) -> Integrator:
    """Make the integrator of a name for a structure."""
    return _chosen(INTEGRATORS, "integrator", name)(structure)


def compensator_of(name: str, steps: float) -> Compensator | None:
    """Make the compensator of a name for an estimated delay [steps]; None for no compensation."""
    return _chosen(COMPENSATORS, "compensator", name)(steps)


def _chosen(choices: Mapping[str, Maker], what: str, name: str) -> Maker:
    if name not in choices:
        raise InputError(
            f"The {what} of the paper's cases must be known",
            value=name,
            remedy=f"Choose among {', '.join(choices)}",
        )
    return choices[name]
