"""Specimens that are not linear, each with a level that is scaled by the response of the linear structure."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from reliab.core.errors import InputError
from reliab.core.vocabulary import Block
from reliab.effects.coulomb_friction import CoulombFriction
from reliab.effects.cubic_stiffness import CubicStiffness
from reliab.effects.effect import Effect, Parameter, Role, SteppedEffect
from reliab.effects.hysteresis import Hysteresis
from reliab.effects.kernel import Kernel, Numbers
from reliab.structures.structure import Structure

HARDENING: Final = 0.02
"""Stiffness after yielding over the elastic one [-], of bilinear and Bouc–Wen specimens."""

_EXPONENT = 2.0  # of Bouc–Wen's equation
_STICKING = 0.02  # of the peak velocity, over which friction changes its sign


class SpecimenKind(StrEnum):
    """Kinds of nonlinear behaviour of a specimen."""

    BILINEAR = "bilinear"
    BOUC_WEN = "bouc_wen"
    COULOMB = "coulomb"
    CUBIC = "cubic"


@dataclass(frozen=True, kw_only=True)
class NonlinearSpecimen:
    """A kind of specimen and how far it is from linear.

    `level`: for `bilinear` and `bouc_wen` the peak of the linear response over the yield displacement, R [-];
    for `coulomb` the friction force, for `cubic` the cubic force, over the force of the linear spring at the
    peak of the linear response [-]; negative for a cubic spring that softens.

    >>> yielding = NonlinearSpecimen(kind=SpecimenKind.BILINEAR, level=4.0)
    >>> (effect,) = yielding.effects(Structure(frequency=1.0, damping_ratio=0.02), 0.08)
    >>> effect.displacement_m
    0.02
    """

    kind: SpecimenKind
    level: float

    def __post_init__(self) -> None:
        if not (self.level > 0.0 or (self.kind is SpecimenKind.CUBIC and self.level < 0.0)):
            raise InputError(
                f"The level of a {self.kind} specimen must be "
                + ("different from zero" if self.kind is SpecimenKind.CUBIC else "positive"),
                value=self.level,
                remedy="Leave a linear specimen out: every specimen is compared with it",
            )

    @property
    def yields(self) -> bool:
        """Whether it has a yield displacement, and with it a ductility."""
        return self.kind in {SpecimenKind.BILINEAR, SpecimenKind.BOUC_WEN}

    def effects(self, structure: Structure, peak: float) -> tuple[Effect, ...]:
        """Return what acts beside the specimen's linear spring, per unit mass of the structure.

        `peak`: peak of the response of the linear structure [m].
        """
        stiffness = structure.experimental_fraction * structure.circular_frequency**2
        if self.kind is SpecimenKind.CUBIC:
            return (CubicStiffness(cubic_n_per_m3=self.level * stiffness / peak**2),)
        if self.kind is SpecimenKind.COULOMB:
            velocity = _STICKING * structure.circular_frequency * peak
            friction = self.level * stiffness * peak
            return (CoulombFriction(force_n=friction, regularisation_velocity_m_per_s=velocity),)
        yielding = peak / self.level
        force = (1.0 - HARDENING) * stiffness * yielding
        if self.kind is SpecimenKind.BILINEAR:
            return (Elastoplastic(force_n=force, displacement_m=yielding),)
        return (Hysteresis(force_n=force, displacement_m=yielding, exponent=_EXPONENT, lost_share=1.0),)


SPECIMENS: Final = tuple(
    NonlinearSpecimen(kind=kind, level=level)
    for kind, levels in (
        (SpecimenKind.BILINEAR, (1.5, 2.0, 4.0, 8.0)),
        (SpecimenKind.BOUC_WEN, (2.0, 4.0)),
        (SpecimenKind.COULOMB, (0.02, 0.05, 0.1, 0.2)),
        (SpecimenKind.CUBIC, (-0.2, -0.1, 0.1, 0.3)),
    )
    for level in levels
)
"""The specimens of the study that ships."""


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: last displacement and elastic part, both over the yield displacement.
    displacement = motion[0] / coefficients[1]
    elastic = min(max(state[1] + displacement - state[0], -1.0), 1.0)
    state[0], state[1] = displacement, elastic
    return coefficients[0] * (elastic - displacement)


@dataclass(frozen=True, kw_only=True)
class Elastoplastic(SteppedEffect):
    """A force f·(z − x/d), z following x/d and held between −1 and 1: the spring loses what yields.

    Beside a linear spring k it makes a bilinear spring of stiffness k before and k − f/d after yielding, with
    kinematic hardening. It is the limit of :class:`reliab.effects.hysteresis.Hysteresis` for an infinite
    exponent, where that equation cannot be stepped.

    `force_n`: force f of the part that yields [N]; `displacement_m`: yield displacement d [m].
    """

    name = "elastoplastic"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "a part of the specimen is elastic and perfectly plastic"
    parameters = (
        Parameter(
            name="force_n",
            units="N",
            meaning="yield force",
            scale=(("force", 1.0),),
            typical=0.5,
            lower=1e-4,
            upper=10.0,
            starts=(0.3,),
        ),
        Parameter(
            name="displacement_m",
            units="m",
            meaning="yield displacement",
            scale=(("displacement", 1.0),),
            typical=0.2,
            lower=1e-4,
            upper=10.0,
            starts=(0.3,),
        ),
    )
    kernel = Kernel(function=_force, states=2)

    force_n: float
    displacement_m: float
