"""The rig of a digital laboratory: transfer system, sensors, converters, limits."""

import math
from dataclasses import dataclass, field

from reliab.errors import InputError
from reliab.simulation.compensators.compensator import Compensator
from reliab.simulation.transfer_systems import ServoHydraulic, TransferSystem


@dataclass(frozen=True, kw_only=True)
class Sensors:
    """White noise and resolution of the two sensors."""

    # displacement_noise, force_noise: Root mean square of the noise [m] and [N], one value held over each
    # step
    displacement_noise: float = 0.0
    force_noise: float = 0.0
    displacement_step: float = 0.0  # displacement_step, force_step: Resolution [m] and [N]; 0 for none
    force_step: float = 0.0
    # Whether both noises are proportional to one sequence, as where one seed serves two generators
    common_noise: bool = False

    def __post_init__(self) -> None:
        for name in ("displacement_noise", "force_noise", "displacement_step", "force_step"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise InputError(
                    f"The {name.replace('_', ' ')} of a sensor must be finite and not negative", value=value
                )


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits of the rig: stroke and rate limit the command, the third limits the force."""

    stroke: float = math.inf  # Largest displacement [m]
    rate: float = math.inf  # Largest velocity [m/s]
    force: float = math.inf  # Largest force [N]

    def __post_init__(self) -> None:
        for name in ("stroke", "rate", "force"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"The limit of the rig's {name} must be positive", value=getattr(self, name))


@dataclass(frozen=True, kw_only=True)
class Rig:
    """Everything between the numerical substructure's target and the force that comes back."""

    # Actuator with its inner loop; the benchmark's by default
    transfer_system: TransferSystem = field(default_factory=ServoHydraulic)
    compensator: Compensator | None = None  # Controller or compensator before it; none by default
    sensors: Sensors = field(default_factory=Sensors)  # Noise and resolution
    limits: Limits = field(default_factory=Limits)  # Limits of the rig; none by default
    command_step: float = 0.0  # Resolution [m] of the converter that sends the command; 0 for none
