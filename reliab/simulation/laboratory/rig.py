"""The rig of a digital laboratory: transfer system, sensors, converters, limits."""

import math
from dataclasses import dataclass, field

from reliab.errors import InputError
from reliab.simulation.compensators.compensator import Compensator
from reliab.simulation.transfer_systems import ServoHydraulic, TransferSystem


@dataclass(frozen=True, kw_only=True)
class Sensors:
    """White noise and resolution of the two sensors.

    Parameters
    ----------
    displacement_noise, force_noise : float, optional
        Root mean square of the noise [m] and [N], one value held over each step.
    displacement_step, force_step : float, optional
        Resolution [m] and [N]; 0 for none.
    common_noise : bool, optional
        Whether both noises are proportional to one sequence, as where one seed serves two generators.

    Raises
    ------
    InputError
        If a number is negative or not finite.
    """

    displacement_noise: float = 0.0
    force_noise: float = 0.0
    displacement_step: float = 0.0
    force_step: float = 0.0
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
    """Limits of the rig: stroke and rate limit the command, the third limits the force.

    Parameters
    ----------
    stroke : float, optional
        Largest displacement [m].
    rate : float, optional
        Largest velocity [m/s].
    force : float, optional
        Largest force [N].

    Raises
    ------
    InputError
        If a limit is not positive.
    """

    stroke: float = math.inf
    rate: float = math.inf
    force: float = math.inf

    def __post_init__(self) -> None:
        for name in ("stroke", "rate", "force"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"The limit of the rig's {name} must be positive", value=getattr(self, name))


@dataclass(frozen=True, kw_only=True)
class Rig:
    """Everything between the numerical substructure's target and the force that comes back.

    Parameters
    ----------
    transfer_system : TransferSystem, optional
        Actuator with its inner loop; the benchmark's by default.
    compensator : Compensator, optional
        Controller or compensator before it; none by default.
    sensors : Sensors, optional
        Noise and resolution.
    limits : Limits, optional
        Limits of the rig; none by default.
    command_step : float, optional
        Resolution [m] of the converter that sends the command; 0 for none.
    """

    transfer_system: TransferSystem = field(default_factory=ServoHydraulic)
    compensator: Compensator | None = None
    sensors: Sensors = field(default_factory=Sensors)
    limits: Limits = field(default_factory=Limits)
    command_step: float = 0.0
