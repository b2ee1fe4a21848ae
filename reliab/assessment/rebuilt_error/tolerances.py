"""Standard deviations of stated values."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields

from reliab.core.physical_range import require_physical


@dataclass(frozen=True, kw_only=True)
class Tolerances:
    """Standard deviations of the values that are stated for a test.

    >>> Tolerances(frequency=0.01).frequency
    0.01
    """

    frequency: float = 0.0  # Of the structure's frequencies, relative [-]
    damping_ratio: float = 0.0  # Of its damping ratios, relative [-]
    # Of the specimen's share α of the stiffness, relative [-]; for matrices of k_e, c_e and m_e
    experimental_fraction: float = 0.0
    sensor_scale: float = 0.0  # Of the scale of the displacement sensor, relative [-]
    sensor_offset: float = 0.0  # Of its offset [m], beyond what is estimated from rest
    # Of a shift in time between the recorded command and the recorded displacement [s]
    time_shift: float = 0.0
    feedback_lag: float = 0.0  # Of the time by which the force is fed back late [s]
    # Of the delay that filters of the two channels do not have in common [s]
    filter_delay: float = 0.0
    # Of the hysteresis of the displacement sensor, width of its loop over the span of the motion [-]: about
    # what was corrected, and where nothing was; no reading leads, so that only draws above zero count there
    hysteresis: float = 0.0
    lagging_hysteresis: float = 0.0
    sensor_drift: float = 0.0  # Of its drift from beginning to end [m], beyond what was taken away
    # Offset and drift [m] of which nobody knows whether the loop felt them: taken away in every second draw
    open_offset: float = 0.0
    open_drift: float = 0.0
    # Delay of a filter of the measured channel [s] of which nobody knows whether the command passed it too:
    # taken away in every second draw
    open_filter: float = 0.0
    # What sensors of several actuators have each by itself, such as "sensor_offset_2", as above
    of_sensors: Mapping[str, float] = field(default_factory=dict)
    # Of parts of the structure, relative [-]: see `reliab.structures.parts_of_structure`
    of_parts: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, value in self.items():
            quantity = "relative standard deviation" if name in _RELATIVE else "number"
            require_physical(quantity, value, zero=True, signed=name in _SIGNED, label=_spoken(name))

    def items(self) -> list[tuple[str, float]]:
        """Names and values in order, without those of parts and of single sensors."""
        names = (item.name for item in fields(self) if not item.name.startswith("of_"))
        return [(name, float(getattr(self, name))) for name in names]


_RELATIVE = (
    "frequency",
    "damping_ratio",
    "experimental_fraction",
    "sensor_scale",
    "hysteresis",
    "lagging_hysteresis",
)
_SIGNED = ("open_offset", "open_drift")


def _spoken(name: str) -> str:
    kind = "relative standard deviation" if name in _RELATIVE else "tolerance"
    return f"{kind} of the {name.replace('_', ' ')}"
