"""The imperfect actuator: a gain and a pure delay."""

import math
from dataclasses import dataclass

from reliab.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Actuator:
    """An actuator that arrives late and at slightly the wrong amplitude, x_m(t) = k_p x_c(t − τ).

    >>> Actuator(gain=0.99, delay=0.001)
    Actuator(gain=0.99, delay=0.001)
    """

    gain: float = 1.0  # Amplitude gain k_p [-], positive
    delay: float = 0.0  # Delay τ [s], not negative

    def __post_init__(self) -> None:
        if not (math.isfinite(self.gain) and self.gain > 0.0):
            raise InputError(
                "The actuator's gain must be positive and finite",
                value=self.gain,
                remedy="Give measured over command amplitude, 1 for a perfect actuator",
            )
        if not (math.isfinite(self.delay) and self.delay >= 0.0):
            raise InputError(
                "The actuator's delay must be finite and not negative",
                value=f"{self.delay} s",
                remedy="Give the delay in seconds, 0.001 for one millisecond",
            )
