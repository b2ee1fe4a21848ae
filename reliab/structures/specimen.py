"""The linear specimen: spring, dashpot, mass."""

import math
from dataclasses import dataclass

from reliab.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Specimen:
    """The specimen without further effects: force = k·x + c·v + m·a of the piston's motion.

    Parameters
    ----------
    stiffness : float
        Stiffness k [N/m], not negative.
    damping : float, optional
        Damping coefficient c [N·s/m].
    mass : float, optional
        Moving mass m [kg], not negative.

    Examples
    --------
    >>> Specimen(stiffness=2000.0).damping
    0.0
    """

    stiffness: float
    damping: float = 0.0
    mass: float = 0.0

    def __post_init__(self) -> None:
        for name in ("stiffness", "mass"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise InputError(
                    f"The specimen's {name} must be finite and not negative",
                    value=value,
                    remedy="Give it in N/m or kg; a softening specimen is an effect",
                )
        if not math.isfinite(self.damping):
            raise InputError("The specimen's damping must be finite", value=self.damping)
