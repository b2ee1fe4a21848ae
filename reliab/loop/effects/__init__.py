"""Effects that may be missing from the model of a hybrid test, one to a file."""

from reliab.loop.effects.effect import (
    Effect,
    LinearEffect,
    RecordEffect,
    Role,
    Setting,
    SteppedEffect,
)
from reliab.loop.effects.kernel import Kernel
from reliab.loop.effects.parameter import Parameter, Scales
from reliab.loop.effects.registry import ENTRY_POINT_GROUP, find_effect, library

__all__ = [
    "ENTRY_POINT_GROUP",
    "Effect",
    "Kernel",
    "LinearEffect",
    "Parameter",
    "RecordEffect",
    "Role",
    "Scales",
    "Setting",
    "SteppedEffect",
    "find_effect",
    "library",
]
