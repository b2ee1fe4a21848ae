"""A and d of a measured test, without effects of the record's ends, and with their uncertainty from noise.

Four things are done beyond equations (1)–(5):

- Offsets are taken off both histories, which would otherwise leak into the lowest frequencies.
- Command and measured displacement pass the same low-pass filter, so that noise recorded with the command
  does not count as command (equation (4) would otherwise average over the noise's frequencies, too). What
  noise is left of it in the band, at the level found above the band, is taken off the power in (1) and (4).
- The index of a constant gain and delay is not exactly that gain and delay: the window weighs earlier
  and later samples differently, and the frequencies spread. A and d are therefore those of the gain and
  delay whose own index, evaluated on the test's command, is the measured one.
- The residual of the measured displacement after gain and delay is noise and other behaviour of the rig; it
gives the uncertainty of A and d (`reliab.assessment.block_bootstrap`).
"""

from dataclasses import dataclass, replace

import numpy as np

from reliab.arrays import Array
from reliab.assessment.band import Band, in_band, noise_floor, power_of
from reliab.assessment.block_bootstrap import index_errors
from reliab.indices import FrequencyEvaluation
from reliab.indices.frequency_evaluation import frequency_evaluation
from reliab.recordings import Recording
from reliab.signals import CubicPath

LEVEL = 0.95
"""Level of the intervals of A and d, and of what follows from them."""

_REFINEMENTS = 3


@dataclass(frozen=True, kw_only=True, eq=False)
class TrackingIndex:
    """How the actuator of a test tracked its command."""

    amplitude: float  # A [-]
    delay: float  # Equivalent delay d [s], positive when the measured displacement lags
    plain: FrequencyEvaluation  # Equations (1)–(5) of the filtered histories as they stand
    draws: Array  # Bootstrap draws of A [-] and d [s], shape (2, draws)
    # RMS of what gain and delay leave of the unfiltered measured displacement, over its own RMS [-]
    noise_share: float
    # Share of noise in the power of the filtered command [-], by which A would be too small had it not been
    # taken off
    attenuation: float
    unexplained_share: float  # As `noise_share`, in the band of the motion and beyond the noise there [-]

    def interval(self, level: float = LEVEL) -> tuple[tuple[float, float], tuple[float, float]]:
        """Intervals of A [-] and d [s] at a level."""
        tails = [0.5 * (1.0 - level), 0.5 * (1.0 + level)]
        (low_a, low_d), (high_a, high_d) = np.quantile(self.draws, tails, axis=1).tolist()
        return (low_a, high_a), (low_d, high_d)

    @property
    def spread(self) -> tuple[float, float]:
        """Half of the central 68 % of A [-] and d [s], as a standard deviation."""
        low, high = np.quantile(self.draws, [0.1587, 0.8413], axis=1)
        of_a, of_d = (0.5 * (high - low)).tolist()
        return of_a, of_d


def track(recording: Recording, *, window: str = "hann", draws: int = 2000, seed: int = 0) -> TrackingIndex:
    """Evaluate how a test tracked its command.

    >>> time = np.arange(0.0, 40.0, 1.0 / 256.0)
    >>> command = np.sin(2.0 * np.pi * time) * np.exp(-time / 15.0)
    >>> late = 0.99 * np.sin(2.0 * np.pi * (time - 0.002)) * np.exp(-(time - 0.002) / 15.0)
    >>> found = track(Recording(command=command, measured=late, time_step=1.0 / 256.0))
    >>> round(found.amplitude, 5), round(1e3 * found.delay, 4)
    (0.99, 2.0)
    """
    recording = replace(recording, command=_centred(recording.command), measured=_centred(recording.measured))
    band, step = in_band(recording), recording.time_step
    plain = _without_noise(frequency_evaluation(band.command, band.measured, step, window=window), band, step)
    path = CubicPath.through(np.arange(band.command.size) * step, band.command)
    gain, delay = plain.amplitude, plain.equivalent_delay
    for _ in range(_REFINEMENTS):
        reference = frequency_evaluation(band.command, _moved(path, gain, delay), step, window=window)
        gain += plain.amplitude - reference.amplitude
        delay += plain.equivalent_delay - reference.equivalent_delay
    residual = band.measured - _moved(path, gain, delay)
    turn = 2.0 * np.pi * plain.equivalent_frequency
    error = index_errors(band.command, residual, window=window, draws=draws, seed=seed) / (
        gain * np.exp(-1j * turn * delay)
    )
    full = CubicPath.through(np.arange(recording.command.size) * step, recording.command)
    noise = recording.measured - _moved(full, gain, delay)
    return TrackingIndex(
        amplitude=gain,
        delay=delay,
        plain=plain,
        draws=np.stack([gain * (1.0 + error.real), delay - error.imag / turn]),
        noise_share=_rms(noise) / _rms(recording.measured),
        attenuation=float(band.noise.sum()),
        unexplained_share=_unexplained(residual, noise, band),
    )


def _moved(path: CubicPath, gain: float, delay: float) -> Array:
    """Command times a gain and later by a delay, without its mean; at rest before the first sample."""
    times = path.times
    return _centred(gain * path(np.clip(times - delay, times[0], times[-1])))


def _centred(values: Array) -> Array:
    """Take off the mean, in which sensors may have an offset."""
    return np.asarray(values - values.mean(), dtype=np.float64)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _without_noise(plain: FrequencyEvaluation, band: Band, step: float) -> FrequencyEvaluation:
    """Take the noise off the command's power in equations (1) and (4)."""
    frequency = (np.arange(band.noise.size) + 1.0) / (band.command.size * step)
    signal = 1.0 - float(band.noise.sum())
    equivalent = (plain.equivalent_frequency - float(band.noise @ frequency)) / signal
    return replace(
        plain,
        amplitude=plain.amplitude / signal,
        equivalent_frequency=equivalent,
        equivalent_delay=-plain.phase / (2.0 * np.pi * equivalent),
    )


def _unexplained(residual: Array, noise: Array, band: Band) -> float:
    """Share of the remainder in the band that noise of the level beyond the band does not account for."""
    floor, _ = noise_floor(noise)
    excess = float(power_of(residual)[: band.bins].sum()) - floor * band.bins
    return float(np.sqrt(max(excess, 0.0) / power_of(band.measured).sum()))
