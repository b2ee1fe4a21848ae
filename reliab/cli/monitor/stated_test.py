"""What options state of a test that is followed."""

from dataclasses import dataclass

from reliab.assessment.rebuilt_error import Monitor, Tolerances
from reliab.errors import InputError
from reliab.stated_value import StatedValue
from reliab.structures import Structure

_MILLISECONDS = 1e-3


@dataclass(frozen=True, kw_only=True)
class StatedTest:
    """What is stated of a test: structure, sensor and feedback, each with its standard deviation."""

    f: StatedValue  # Natural frequency [Hz]
    xi: StatedValue  # Damping ratio [-]
    alpha: StatedValue  # Share of the stiffness in the laboratory [-]
    scale: StatedValue  # Scale of the displacement sensor [-]
    feedback_lag: StatedValue  # Time by which the force is fed back late [ms]

    def __post_init__(self) -> None:
        if not self.scale.value > 0.0:
            raise InputError("The sensor's scale must be positive", value=self.scale.value)

    @classmethod
    def parse(cls, **texts: str) -> "StatedTest":
        """Read the texts of options, by their names."""
        return cls(
            **{
                name: StatedValue.parse(text, f"value of --{name.replace('_', '-')}")
                for name, text in texts.items()
            }
        )

    def monitor(self, step: float) -> Monitor:
        """Begin to follow a test of this structure.

        `step` [s].
        """
        structure = Structure(
            frequency=self.f.value, damping_ratio=self.xi.value, experimental_fraction=self.alpha.value
        )
        tolerances = Tolerances(
            frequency=self.f.deviation / self.f.value,
            damping_ratio=self.xi.deviation / self.xi.value,
            experimental_fraction=self.alpha.deviation / self.alpha.value,
            sensor_scale=self.scale.deviation / self.scale.value,
            feedback_lag=self.feedback_lag.deviation * _MILLISECONDS,
        )
        return Monitor(
            structure, step, feedback_lag=self.feedback_lag.value * _MILLISECONDS, tolerances=tolerances
        )
