"""How much amplitude error and delay a test tolerates when its specimen is not linear."""

from .specimens import SPECIMENS, NonlinearSpecimen, SpecimenKind
from .summary import NARROWEST, compare_levels, compare_limits
from .tolerances import DIRECTIONS, FARTHEST, tolerances

__all__ = [
    "DIRECTIONS",
    "FARTHEST",
    "NARROWEST",
    "SPECIMENS",
    "NonlinearSpecimen",
    "SpecimenKind",
    "compare_levels",
    "compare_limits",
    "tolerances",
]
