"""What an uncertain quantity contributes to the interval of an error."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Widening:
    """Effect of one uncertain quantity on the interval."""

    name: str  # The tolerance, or "sensor_noise" or "initial_state"
    deviation: float  # Its standard deviation, relative or in SI units; zero for noise
    contribution: float  # Standard deviation of the error that it alone causes [-]
    width: float  # Width of the 90 % interval [-]
    width_without: float  # Width if this were known exactly [-]
    # Standard deviation at which the width is halved; None where no value does so alone
    deviation_for_half: float | None
