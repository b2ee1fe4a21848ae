"""Effects that may be missing from the model of a hybrid test, one to a file."""

from reliab.effects.effect import (
    Effect,
    LinearEffect,
    RecordEffect,
    Role,
    Setting,
    SteppedEffect,
)
from reliab.effects.kernel import Kernel
from reliab.effects.parameter import Parameter, Scales
from reliab.effects.registry import ENTRY_POINT_GROUP, find_effect, library

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
