"""How much amplitude error and delay a test tolerates when its specimen is not linear."""

from reliab.validation.ductility.specimens import SPECIMENS, NonlinearSpecimen, SpecimenKind
from reliab.validation.ductility.summary import NARROWEST, compare_levels, compare_limits
from reliab.validation.ductility.tolerances import DIRECTIONS, FARTHEST, tolerances

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
