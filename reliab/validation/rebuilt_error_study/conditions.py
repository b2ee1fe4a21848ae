"""Conditions under which a test is judged: its displacement sensor, and the stated structure."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error import Tolerances
from reliab.structures import Structure

QUANTISED: Final = "quantised, 40 dB"
RIGHT: Final = "right"

_DECIBELS: Final[Mapping[str, float]] = MappingProxyType(
    {"20 dB": 20.0, "30 dB": 30.0, "40 dB": 40.0, "60 dB": 60.0, QUANTISED: 40.0}
)


@dataclass(frozen=True, kw_only=True)
class Condition:
    """A sensor, and the structure as the laboratory states it."""

    # White noise so many decibels below the RMS of the motion, "20 dB" to "60 dB", or a sensor whose steps
    # are as coarse, "quantised, 40 dB"
    sensor: str
    # The quantity that is stated wrongly: "frequency", "damping_ratio" or "experimental_fraction"; nothing by
    # default
    quantity: str = ""
    wrong_by: float = 0.0  # By how much, relative [-]; stated as the tolerance too

    @property
    def stated(self) -> str:
        """What is wrong, in words."""
        if not self.quantity:
            return RIGHT
        symbol = {"frequency": "f", "damping_ratio": "ξ", "experimental_fraction": "α"}[self.quantity]
        return f"{symbol} {100.0 * self.wrong_by:+.0f} %".replace("-", "−")

    def structure(self, true: Structure) -> Structure:
        """Structure that the laboratory states."""
        if not self.quantity:
            return true
        return replace(true, **{self.quantity: (1.0 + self.wrong_by) * getattr(true, self.quantity)})

    @property
    def tolerances(self) -> Tolerances:
        """Standard deviations that it states."""
        deviations: dict[str, Any] = {self.quantity: abs(self.wrong_by)} if self.quantity else {}
        return Tolerances(**deviations)

    def read(self, true: Array, rng: np.random.Generator) -> Array:
        """Record a true history [m or N], shape (n,), as the sensor shows it."""
        level = 10.0 ** (-_DECIBELS[self.sensor] / 20.0) * float(np.sqrt(np.mean(true**2)))
        if self.sensor == QUANTISED:
            width = np.sqrt(12.0) * level
            return np.asarray(width * np.round(true / width + rng.uniform(-0.5, 0.5)), dtype=np.float64)
        return np.asarray(true + level * rng.standard_normal(true.size), dtype=np.float64)


PLAIN: Final = Condition(sensor="40 dB")
"""The condition in which judges are compared."""

CONDITIONS: Final = (
    PLAIN,
    *(Condition(sensor=name) for name in _DECIBELS if name != PLAIN.sensor),
    Condition(sensor=PLAIN.sensor, quantity="frequency", wrong_by=0.02),
    Condition(sensor=PLAIN.sensor, quantity="frequency", wrong_by=-0.02),
    Condition(sensor=PLAIN.sensor, quantity="damping_ratio", wrong_by=0.2),
    Condition(sensor=PLAIN.sensor, quantity="damping_ratio", wrong_by=-0.2),
    Condition(sensor=PLAIN.sensor, quantity="experimental_fraction", wrong_by=-0.05),
)
"""Every sensor with the structure stated rightly, and every wrong statement with the sensor of 40 dB."""
