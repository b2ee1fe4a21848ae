"""A damping of the numerical structure that is not the stated one."""

from dataclasses import dataclass, replace

from reliab.core.physical_range import RANGES
from reliab.core.vocabulary import Block
from reliab.effects.effect import Effect, Role
from reliab.effects.viscous_damping import ViscousDamping
from reliab.simulation.hybrid_test.model import HybridTest

_LEAST = RANGES["damping ratio"].lowest  # a structure has some


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


def apply_damping(model: HybridTest) -> HybridTest:
    """Return a model whose structure has the damping that its effects give it."""
    changes = [effect for effect in model.effects if isinstance(effect, StatedDamping)]
    if not changes or model.structure is None:
        return model
    damping = model.mass * model.substructure.damping
    factor = 1.0 + sum(change.damping_n_s_per_m for change in changes) / damping
    ratio = max(factor * model.structure.damping_ratio, _LEAST)
    other_effects = tuple(effect for effect in model.effects if not isinstance(effect, StatedDamping))
    return replace(model, structure=replace(model.structure, damping_ratio=ratio), effects=other_effects)
