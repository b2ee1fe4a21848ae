"""A damping of the controller's structure that is not the stated one; no member of the library."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Effect, Role
from reliab.effects.viscous_damping import ViscousDamping


@dataclass(frozen=True, kw_only=True)
class StatedDamping(Effect):
    """Damping of the controller's structure beside the stated one, c(1 + Δ) in the place of c.

    In one channel it can hardly be told from a damper in the specimen, nor, where it is negative, from an
    added mass with a gain. Its prior is that of a damper.
    """

    name = "structure_damping"
    block = Block.NUMERICAL
    role = Role.INTEGRATION
    description = "the damping ratio of the structure is not the stated one"
    parameters = ViscousDamping.parameters

    damping_n_s_per_m: float  # Δc [N·s/m]
