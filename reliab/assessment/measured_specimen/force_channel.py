"""What stands between the force of a specimen and the force that was recorded and fed back.

The recorded force is F(t) = f(t − lag) + m_a x_m'' + r sign(x_m'): a lag or the filter of the force against
the displacement, the inertia of what is mounted between load cell and specimen, and friction in the path of
the load.
"""

from collections.abc import Iterable
from dataclasses import dataclass, fields

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI

_SLOW = 0.02  # of the largest speed, below which friction follows the velocity


@dataclass(frozen=True, kw_only=True)
class ForceChannel:
    """Stated properties of the recorded force, each with its standard deviation.

    >>> ForceChannel.parse(["lag_ms=2±0.5"]).lag_ms
    StatedValue(value=2.0, deviation=0.5)
    """

    lag_ms: StatedValue = StatedValue(0.0)  # noqa: RUF009 - Time by which it follows the displacement [ms]
    attached_kg: StatedValue = StatedValue(0.0)  # noqa: RUF009 - Mass between load cell and specimen [kg]
    friction_n: StatedValue = StatedValue(0.0)  # noqa: RUF009 - Friction in the load path [N]

    @classmethod
    def parse(cls, texts: Iterable[str]) -> "ForceChannel":
        """Read what is stated: "lag_ms=2±0.5", "attached_kg=12±1", "friction_n=40±20"."""
        names, values = [field.name for field in fields(cls)], {}
        for text in texts:
            name, _, value = text.partition("=")
            if name not in names or name in values:
                raise InputError(
                    "A `force_channel` states the force's lag, attached mass or friction, each once",
                    value=repr(text),
                    remedy="Write lag_ms=2±0.5, attached_kg=12±1 or friction_n=40±20",
                )
            values[name] = StatedValue.parse(value, name)
            if values[name].value < 0.0 and name != "lag_ms":
                raise InputError(
                    "Attached mass and friction are not negative",
                    value=repr(text),
                    remedy="Write attached_kg=12±1 or friction_n=40±20",
                )
        return cls(**values)

    @property
    def values(self) -> Array:
        """Lag [s], mass [kg] and friction [N], shape (3,)."""
        return np.array([self.lag_ms.value / MILLI, self.attached_kg.value, self.friction_n.value])

    @property
    def has_lag(self) -> bool:
        """Whether its lag is stated."""
        return self.lag_ms != StatedValue(0.0)

    @property
    def deviations_by_name(self) -> dict[str, float]:
        """Standard deviations of what is stated, by names of quantities."""
        return {
            **({"force_lag": self.lag_ms.deviation / MILLI} if self.has_lag else {}),
            "attached_mass": self.attached_kg.deviation,
            "load_path_friction": self.friction_n.deviation,
        }


NOTHING_STATED = ForceChannel()
"""A recorded force that is that of the specimen."""


def columns_of_channel(force: Array, displacement: Array, step: float) -> Array:
    """Say what a unit of lag, mass and friction adds to a force [N] along a displacement [m], (3, n)."""
    velocity = np.gradient(displacement, step)
    slow = _SLOW * float(np.abs(velocity).max())
    return np.stack([-np.gradient(force, step), np.gradient(velocity, step), np.tanh(velocity / slow)])
