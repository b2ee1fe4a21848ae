"""One campaign before it is written: the true system, what is observed, the inputs and the noise."""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from blind_campaigns.noise import Noise
from blind_campaigns.simulator import FINEST_HZ, Response, simulate_loop, simulate_prescribed
from blind_campaigns.system import Array, Rig


class Observation(StrEnum):
    """What a campaign records, and whether its loop is closed."""

    FULL = "full"
    COMMAND_MEASURED = "command_measured"
    MEASURED_FORCE = "measured_force"
    ACTUATOR_ONLY = "actuator_only"
    SPECIMEN_ONLY = "specimen_only"
    ONE_CHANNEL_RIG = "one_channel_rig"
    ONE_CHANNEL_OSCILLATOR = "one_channel_oscillator"


COLUMNS = {
    Observation.FULL: ("ground_acceleration_mps2", "command_m", "measured_m", "force_n"),
    Observation.COMMAND_MEASURED: ("command_m", "measured_m"),
    Observation.MEASURED_FORCE: ("measured_m", "force_n"),
    Observation.ACTUATOR_ONLY: ("command_m", "measured_m"),
    Observation.SPECIMEN_ONLY: ("measured_m", "force_n"),
    Observation.ONE_CHANNEL_RIG: ("ground_acceleration_mps2", "measured_m"),
    Observation.ONE_CHANNEL_OSCILLATOR: ("ground_acceleration_mps2", "measured_m"),
}
OPEN_LOOP = (Observation.ACTUATOR_ONLY, Observation.SPECIMEN_ONLY)
ONE_CHANNEL = (Observation.ONE_CHANNEL_RIG, Observation.ONE_CHANNEL_OSCILLATOR)


@dataclass(frozen=True, kw_only=True)
class Case:
    """The true system of a campaign, its recorded inputs (ground acceleration or command) and its noise.

    `noise_rms` holds the root mean square of the noise by channel.
    """

    rig: Rig
    observation: Observation
    rate_hz: float
    inputs: tuple[Array, ...]
    motions: tuple[str, ...]
    held_out: tuple[bool, ...]
    numbers: tuple[int, ...]
    noise: Noise
    noise_rms: dict[str, float]

    def having(self, rig: Rig) -> "Case":
        """Return the same campaign with another true system."""
        return replace(self, rig=rig)

    @property
    def closed(self) -> bool:
        """Whether the command comes from the loop."""
        return self.observation not in OPEN_LOOP

    @property
    def training(self) -> "Case":
        """The same campaign without its held-out tests."""
        kept = [i for i, out in enumerate(self.held_out) if not out]
        return self.subset(kept)

    def subset(self, kept: list[int]) -> "Case":
        """Return the same campaign with some of its tests."""
        return replace(
            self,
            inputs=tuple(self.inputs[i] for i in kept),
            motions=tuple(self.motions[i] for i in kept),
            held_out=tuple(self.held_out[i] for i in kept),
            numbers=tuple(self.numbers[i] for i in kept),
        )

    def run(self, finest_hz: float = FINEST_HZ) -> list[Response]:
        """Return the noise-free responses of all tests."""
        simulate = simulate_loop if self.closed else simulate_prescribed
        return [simulate(self.rig, given, rate_hz=self.rate_hz, finest_hz=finest_hz) for given in self.inputs]


def root_mean_square(parts: list[Array]) -> float:
    """Return the root mean square over several signals together."""
    return float(
        np.sqrt(sum(float(np.square(part).sum()) for part in parts) / sum(part.size for part in parts))
    )


def decibels(ratio: float) -> float:
    """Return an amplitude ratio in dB, never below −200."""
    return float(20.0 * np.log10(max(ratio, 1e-10)))
