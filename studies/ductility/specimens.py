"""Specimens that are not linear, each with a level that is scaled by the response of the linear structure."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from reliab.effects import CoulombFriction, CubicStiffness, Effect, Hysteresis
from reliab.errors import InputError
from reliab.structures import Structure

from .elastoplastic import Elastoplastic

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
