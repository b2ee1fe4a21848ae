"""One possible world: structure and channels of a test with everything that is uncertain set to a value."""

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.core.arrays import Array, Spectrum
from reliab.structures.partition import Partition


@dataclass(kw_only=True, eq=False)
class Experiment:
    """Values of everything that is uncertain; quantities change them one after another."""

    frequency: float = 1.0  # Factor of all natural frequencies [-]
    damping_ratio: float = 1.0  # Factor of all damping ratios [-]
    share: float = 1.0  # Factor of the specimen's matrices [-]
    parts: dict[str, float] = field(default_factory=dict)  # Relative changes of parts of a frame [-]
    scale: Array = None  # type: ignore[assignment]  # Readings of the displacement sensors over the motion [-], (p,)
    skew: Array = None  # type: ignore[assignment]  # Time by which they were recorded late [s], (p,)
    hysteresis: Array = None  # type: ignore[assignment]  # Width of their hysteresis over the span [-], (p,)
    offset: Array = None  # type: ignore[assignment]  # Constant part of their readings [m], (p,)
    drift: Array = None  # type: ignore[assignment]  # Rise of their readings over the test [m], (p,)
    feedback_lag: float = 0.0  # Time by which the force is fed back late [s]
    ground_scale: float = 1.0  # Recorded ground acceleration over the true one [-]
    ground_skew: float = 0.0  # Time by which it was recorded late [s]
    force_scale: Array = None  # type: ignore[assignment]  # Recorded forces over the true ones [-], (p,)
    force_skew: Array = None  # type: ignore[assignment]  # Time by which they were recorded late [s], (p,)
    specimen_lead: float = 0.0  # Time by which its viscous damping makes a specimen's force early [s]
    attached_mass: float = 0.0  # Between load cell and specimen, beyond the stated one [kg]
    load_path_friction: float = 0.0  # Beyond the stated one [N]
    initial_displacement: float = 0.0  # Error of the command at the first sample [m]
    initial_velocity: float = 0.0  # Its rate over the lowest natural frequency [m]
    ground_interpolation: float = 0.0  # What the computer adds to it over (ω·step)² of it [-]
    integration: float = 0.0  # Error of the numerical integration over (ω·step)² of the specimen's force [-]

    noise: Spectrum | float = 0.0  # Noise that is left in the denoised readings [m], shape (p, K)
    slip: Spectrum | None = None  # Displacement that a yielding specimen's spring has lost [m], shape (p, K)

    @classmethod
    def as_stated(cls, actuators: int) -> "Experiment":
        """Start from values that leave everything as stated."""
        scale, force_scale = np.ones((2, actuators))
        skew, hysteresis, offset, drift, force_skew = np.zeros((5, actuators))
        return cls(
            scale=scale,
            skew=skew,
            hysteresis=hysteresis,
            offset=offset,
            drift=drift,
            force_scale=force_scale,
            force_skew=force_skew,
        )

    def change(self, name: str, value: float, actuator: int, *, by_factor: bool) -> None:
        """Change a value by a difference, or by a relative one; one of another name is a part of a frame."""
        values = getattr(self, name, None)
        if values is None:
            self.parts[name] = value
        elif isinstance(values, np.ndarray):
            values[actuator] = _changed(values[actuator], value, by_factor=by_factor)
        else:
            setattr(self, name, _changed(values, value, by_factor=by_factor))

    def structure(self, partition: Partition) -> Partition:
        """Structure of this world."""
        factors = self.frequency, self.damping_ratio, self.share
        return _scale_structure(partition, *factors, tuple(self.parts.items()))

    def displacement(self, channels: ChannelSpectra) -> Spectrum:
        """Return the true displacement of the interface [m], freed of the sensors' noise, shape (p, K)."""
        return self._displacement(channels, channels.tracked + self.noise)

    def reading(self, channels: ChannelSpectra) -> Spectrum:
        """Return the same with the sensors' noise, whose size a likelihood has to see."""
        return self._displacement(channels, channels.measured)

    def _displacement(self, channels: ChannelSpectra, read: Spectrum) -> Spectrum:
        additions = self.offset[:, np.newaxis] * channels.constant + self.drift[:, np.newaxis] * channels.ramp
        if self.hysteresis.any():
            additions -= channels.hysteresis_lag(self.hysteresis)
        actuator_displacements = (read - additions) * channels.band.advance(self.skew)
        actuator_displacements /= self.scale[:, np.newaxis]
        return np.asarray(channels.to_interface @ actuator_displacements)

    def late(self, motion: Spectrum, channels: ChannelSpectra) -> Spectrum:
        """Displacement [m], or force [N], of the instant whose force the loop received, shape (p, K)."""
        if not self.feedback_lag:
            return motion
        return np.asarray(motion * channels.band.advance(-self.feedback_lag))

    def ground(self, channels: ChannelSpectra) -> Spectrum | None:
        """Return the true ground acceleration [m/s²], shape (K,); None where it was not recorded."""
        if channels.ground is None:
            return None
        interpolation = 1.0 + self.ground_interpolation * (channels.band.s * channels.band.record_step) ** 2
        earlier = channels.band.advance(self.ground_skew)
        return np.asarray(channels.ground * interpolation / self.ground_scale * earlier)

    def force(self, channels: ChannelSpectra) -> Spectrum | None:
        """Return the true force of the specimen at the interface [N], shape (p, K); None if not recorded."""
        if channels.force is None:
            return None
        forces = channels.force * channels.band.advance(self.force_skew) / self.force_scale[:, np.newaxis]
        return channels.force_at_interface(forces)


def _changed(stated: float, value: float, *, by_factor: bool) -> float:
    return stated * (1.0 + value) if by_factor else stated + value


@lru_cache(maxsize=8)
def _scale_structure(
    partition: Partition,
    frequency: float,
    damping_ratio: float,
    share: float,
    parts: tuple[tuple[str, float], ...],
) -> Partition:
    structure = partition.change_parts(dict(parts)) if parts else partition
    return structure.scale(frequency=frequency, damping_ratio=damping_ratio, share=share)
