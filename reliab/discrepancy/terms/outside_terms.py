"""The terms that are tried in each block."""

from functools import cache

from reliab.discrepancy.terms.amplitude_delay import AmplitudeDelay
from reliab.discrepancy.terms.monomial import monomial
from reliab.discrepancy.terms.one_sided import OneSidedSpring
from reliab.discrepancy.terms.relaxation import Relaxation
from reliab.discrepancy.terms.worn import GrowingSlack, WornSpring
from reliab.effects import Effect, Role
from reliab.vocabulary import Block

_FORCES = (
    {"abs_x": 1}, {"x": 1, "abs_x": 1}, {"x": 4}, {"x": 5}, {"abs_x": 3},
    {"abs_v": 1}, {"v": 2}, {"v": 3}, {"v": -0.5, "abs_v": 0.5},
    {"x": 1, "v": 1}, {"abs_x": 1, "v": 1}, {"x": 2, "v": 1}, {"x": 1, "abs_v": 1}, {"x": 1, "v": 2},
    {"x": 2, "v": -0.5}, {"abs_x": 1, "v": -0.5}, {"abs_x": 1, "v": 1, "abs_v": 1},
    {"t": 1}, {"t": 1, "x": 1}, {"t": 1, "v": 1}, {"t": 1, "x": 3}, {"t": 1, "v": -0.5},
)  # fmt: skip

_PISTON = (
    {"abs_x": 1}, {"x": 2}, {"x": 1, "abs_x": 1}, {"x": 3},
    {"t": 1, "x": 1}, {"t": 2, "v": 1}, {"abs_v": 1},
    {"abs_x": 1, "v": 1}, {"x": 2, "v": 1}, {"x": 1, "v": 1}, {"v": 1, "abs_v": 1},
    {"x": 1, "abs_v": 1}, {"v": 3},
)  # fmt: skip

_READINGS = ({"x": 2}, {"x": 3})


@cache
def outside_terms(block: Block) -> tuple[type[Effect], ...]:
    """Terms of a block."""
    if block is Block.SPECIMEN:
        terms = [monomial(Role.FORCE, **exponents) for exponents in _FORCES]
        return (*terms, OneSidedSpring, Relaxation, WornSpring, GrowingSlack)
    if block is Block.ACTUATOR:
        terms = [monomial(Role.PISTON, **exponents) for exponents in _PISTON]
        return (*terms, AmplitudeDelay)
    return ()
