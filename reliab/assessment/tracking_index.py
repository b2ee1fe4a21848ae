"""How the actuator of a test tracked: A and d with uncertainty, also in windows, and established measures.

A and d are those of equations (1)–(5), without effects of the record's ends. Four things are done beyond:

- Offsets are taken off both histories, which would otherwise leak into the lowest frequencies.
- Command and measured displacement pass the same low-pass filter, so that noise recorded with the command
  does not count as command (equation (4) would otherwise average over the noise's frequencies, too). What
  noise is left of it in the band, at the level found above the band, is taken off the power in (1) and (4).
- The index of a constant gain and delay is not exactly that gain and delay: the window weighs earlier
  and later samples differently, and the frequencies spread. A and d are therefore those of the gain and
  delay whose own index, evaluated on the test's command, is the measured one.
- The residual of the measured displacement after gain and delay is noise and other behaviour of the rig; it
  gives the uncertainty of A and d. The index is linear in the measured displacement, so that each stretch of
  the residual contributes to its error on its own. Blocks of contributions, long enough that neighbours are
  unrelated, get random weights (dependent wild bootstrap, Shao 2010), each as if the index had been found
  without its block (delete-one jackknife), with the heavier tails of Student's t where a few blocks hold most
  of the motion.

References
----------
Politis, D. N. (2003). Adaptive bandwidth choice. *Journal of Nonparametric Statistics* 15, 517-533.
Shao, X. (2010). The dependent wild bootstrap. *Journal of the American Statistical Association* 105, 218-235.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import ReliabError
from reliab.recordings.recording import FEWEST_SAMPLES, Recording
from reliab.signals.cubic_path import CubicPath
from reliab.signals.spectra import hann, periodogram, taper, upper_level
from reliab.tracking.indices.tracking import (
    CommandSpectrum,
    FrequencyEvaluation,
    delay_by_cross_correlation,
    energy_error,
    maximum_tracking_error,
    phase_amplitude_errors,
    rms_tracking_error,
    tracking_indicator,
)

_FLOOR_FACTOR = 10.0
_SMOOTHING_BINS = 16  # bins over which a periodogram is averaged
_NOISIER, _ROUNDING = 10.0, 5e-9  # in power
_ROOM = 0.9  # share of the Nyquist frequency up to which a filter is worth while

LEVEL = 0.95
"""Level of the intervals of A and d, and of what follows from them."""

_REFINEMENTS = 3
_WINDOW = "hann"  # of the spectra

_CELLS = 1024  # stretches whose contributions are summed before blocks are formed
_RUN = 5  # lags that must be quiet
_FEWEST_BLOCKS = 12
_REACHES = 3  # length of a block in lags at which contributions are still correlated
_HIGHEST_LEVERAGE = 0.9

_PERIODS = 8.0  # of the equivalent frequency in a window
_MOST_WINDOWS = 40
_FEWEST_WINDOWS = 3
_QUIET = 0.05  # share of the largest mean square of a window; windows below it are left out
_DRAWS = 400
_DEVIATIONS = 2.5


@dataclass(frozen=True, kw_only=True, eq=False)
class Band:
    """Histories in the band of the motion, and the noise of the command."""

    command: Array  # command, measured: Filtered histories [m], shape (n,)
    measured: Array
    bins: int  # Bins of a periodogram in which the command rises above its noise
    noise: Array  # Noise in the filtered command by bin, over the command's power [-], shape (n // 2,)


def filter_to_band(recording: Recording) -> Band:
    """Filter both histories alike at twice the highest frequency where the command rises above its noise."""
    power = power_of(recording.command)
    floor = upper_level(power)
    smooth = np.convolve(power, np.full(_SMOOTHING_BINS, 1.0 / _SMOOTHING_BINS), mode="same")
    bins = int(np.flatnonzero(smooth >= np.minimum(_FLOOR_FACTOR * floor, smooth.max()))[-1]) + 1
    histories, gain = [recording.command, recording.measured], np.ones(power.size)
    total = power.sum()
    if 2 * bins < _ROOM * power.size:
        sections = scipy.signal.butter(4, 2.0 * bins / power.size, output="sos")
        histories = [np.asarray(scipy.signal.sosfiltfilt(sections, history)) for history in histories]
        gain = np.abs(scipy.signal.sosfreqz(sections, power.size)[1]) ** 4  # forwards and backwards
        total = power_of(histories[0]).sum()
    noise = floor * gain / float(total)
    return Band(command=histories[0], measured=histories[1], bins=bins, noise=noise)


def noise_floor(values: Array) -> tuple[float, float]:
    """Level of the upper half of a periodogram, per bin, and its total."""
    power = power_of(values)
    return upper_level(power), float(power.sum())


def white_noise_share(values: Array) -> float:
    """Share of white noise in the power of a history, shape (n,), by the upper half of its spectrum [-]."""
    floor, total = noise_floor(values)
    return 0.5 * floor * values.size / total  # a periodogram has half as many bins as samples


def is_noisier(first: Array, second: Array) -> bool:
    """Whether a history has far more white noise than another, as a reading has beside a command."""
    noise = white_noise_share(first)
    return noise > _ROUNDING and noise > _NOISIER * white_noise_share(second)


def power_of(values: Array) -> Array:
    """Periodogram of a history, shape (n,), by frequency above zero."""
    return periodogram(values, hann(values.size))


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
    def amplitude_interval(self) -> tuple[float, float]:
        """95 % interval of A [-]."""
        return self.interval()[0]

    @property
    def delay_interval(self) -> tuple[float, float]:
        """95 % interval of d [s]."""
        return self.interval()[1]

    @property
    def phase(self) -> float:
        """Phase of the measured displacement at the equivalent frequency [rad]."""
        return -2.0 * np.pi * self.plain.equivalent_frequency * self.delay

    @property
    def signal_to_noise(self) -> float:
        """Measured motion over what gain and delay leave of it [dB]."""
        return -20.0 * float(np.log10(max(self.noise_share, 1e-15)))

    @property
    def amplitude_correction(self) -> float:
        """By how much A differs from that of equations (1)–(5) [-]."""
        return self.amplitude - self.plain.amplitude

    @property
    def delay_correction(self) -> float:
        """By how much d differs from that of equations (1)–(5) [s]."""
        return self.delay - self.plain.equivalent_delay

    @property
    def spread(self) -> tuple[float, float]:
        """Half of the central 68 % of A [-] and d [s], as a standard deviation."""
        low, high = np.quantile(self.draws, [0.1587, 0.8413], axis=1)
        a_spread, d_spread = (0.5 * (high - low)).tolist()
        return a_spread, d_spread


def track(recording: Recording, *, draws: int = 2000, seed: int = 0) -> TrackingIndex:
    """Evaluate how a test tracked its command.

    >>> time = np.arange(0.0, 40.0, 1.0 / 256.0)
    >>> command = np.sin(2.0 * np.pi * time) * np.exp(-time / 15.0)
    >>> late = 0.99 * np.sin(2.0 * np.pi * (time - 0.002)) * np.exp(-(time - 0.002) / 15.0)
    >>> found = track(Recording(command=command, measured=late, time_step=1.0 / 256.0))
    >>> round(found.amplitude, 5), round(1e3 * found.delay, 4)
    (0.99, 2.0)
    """
    recording = replace(
        recording, command=_remove_mean(recording.command), measured=_remove_mean(recording.measured)
    )
    band, step = filter_to_band(recording), recording.time_step
    command_spectrum = CommandSpectrum(command=band.command, time_step=step, window=_WINDOW)
    plain = _subtract_noise(command_spectrum.evaluate(band.measured), band, step)
    path = CubicPath.interpolate(np.arange(band.command.size) * step, band.command)
    gain, delay = plain.amplitude, plain.equivalent_delay
    for _ in range(_REFINEMENTS):
        reference = command_spectrum.evaluate(_scale_and_delay(path, gain, delay))
        gain += plain.amplitude - reference.amplitude
        delay += plain.equivalent_delay - reference.equivalent_delay
    residual = band.measured - _scale_and_delay(path, gain, delay)
    turn = 2.0 * np.pi * plain.equivalent_frequency
    error = index_errors(band.command, residual, draws=draws, seed=seed) / (gain * np.exp(-1j * turn * delay))
    full = CubicPath.interpolate(np.arange(recording.command.size) * step, recording.command)
    noise = recording.measured - _scale_and_delay(full, gain, delay)
    return TrackingIndex(
        amplitude=gain,
        delay=delay,
        plain=plain,
        draws=np.stack([gain * (1.0 + error.real), delay - error.imag / turn]),
        noise_share=_rms(noise) / _rms(recording.measured),
        attenuation=float(band.noise.sum()),
        unexplained_share=_unexplained_share(residual, noise, band),
    )


def _scale_and_delay(path: CubicPath, gain: float, delay: float) -> Array:
    """Command times a gain and later by a delay, without its mean; at rest before the first sample."""
    return _remove_mean(gain * path.read_delayed(delay))


def _remove_mean(values: Array) -> Array:
    """Take off the mean, in which sensors may have an offset."""
    return np.asarray(values - values.mean(), dtype=np.float64)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _subtract_noise(plain: FrequencyEvaluation, band: Band, step: float) -> FrequencyEvaluation:
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


def _unexplained_share(residual: Array, noise: Array, band: Band) -> float:
    """Share of the remainder in the band that noise of the level beyond the band does not account for."""
    floor, _ = noise_floor(noise)
    excess = float(power_of(residual)[: band.bins].sum()) - floor * band.bins
    return float(np.sqrt(max(excess, 0.0) / power_of(band.measured).sum()))


def index_errors(
    command: Array, residual: Array, *, draws: int = 2000, seed: int = 0
) -> NDArray[np.complex128]:
    """Draw errors of FEI that noise may have caused.

    `command`, `residual` [m]; returns [-].

    >>> time = np.arange(0.0, 40.0, 0.01)
    >>> noise = 0.01 * np.random.default_rng(1).normal(size=time.size)
    >>> found = index_errors(np.sin(6.0 * time), noise)
    >>> round(float(found.real.std()), 4)  # 0.01 √(2 · 1.94 / 4000)
    0.0003
    """
    contribution, energy = _contributions(command, residual)
    blocks, leverage = _blocks(contribution, energy)
    rng = np.random.default_rng(seed)
    parts = np.ascontiguousarray(blocks / (1.0 - leverage)).view(np.float64).reshape(-1, 2)
    sums = rng.multivariate_normal(np.zeros(2), parts.T @ parts, draws)  # of blocks with normal weights
    freedom = max(1.0 / float(np.sum(leverage**2)) - 1.0, 1.0)
    tails = np.sqrt(freedom / rng.chisquare(freedom, draws))
    return np.asarray(tails * (sums[:, 0] + 1j * sums[:, 1]), dtype=np.complex128)


def _contributions(command: Array, residual: Array) -> tuple[NDArray[np.complex128], Array]:
    """Sum of a stretch's part in Σ F[left] F[I]* / Σ|F[I]|², and its share in the command's energy."""
    weights = taper(_WINDOW, command.size)
    points = 1 << (command.size - 1).bit_length()
    spectrum = np.fft.fft(command * weights, points)
    spectrum[0], spectrum[points // 2 :] = 0.0, 0.0
    analytic = weights * np.fft.ifft(spectrum)[: command.size] * points
    edges = np.linspace(0, command.size, min(_CELLS, command.size) + 1).astype(np.int64)[:-1]
    parts = np.add.reduceat(residual * analytic.conj(), edges) / float(np.sum(np.abs(spectrum) ** 2))
    energy = np.add.reduceat(np.abs(analytic) ** 2, edges)
    return np.asarray(parts, dtype=np.complex128), energy / energy.sum()


def _blocks(contribution: NDArray[np.complex128], energy: Array) -> tuple[NDArray[np.complex128], Array]:
    effective = 1.0 / float(np.sum(energy**2))
    reach = max(_reach(part, effective) for part in (contribution.real, contribution.imag))
    length = min(max(_REACHES * reach, 1), contribution.size // _FEWEST_BLOCKS)
    edges = np.arange(0, contribution.size, max(length, 1))
    leverage = np.minimum(np.add.reduceat(energy, edges), _HIGHEST_LEVERAGE)
    return np.asarray(np.add.reduceat(contribution, edges), dtype=np.complex128), leverage


def _reach(values: Array, effective: float) -> int:
    """Lag beyond which values are no longer correlated (Politis 2003), over a number of effective values."""
    centred_values = values - values.mean()
    spectrum = np.abs(np.fft.rfft(centred_values, 2 * centred_values.size)) ** 2
    correlation = np.fft.irfft(spectrum)[: centred_values.size]
    if not correlation[0] > 0.0:
        return 0
    limit = 2.0 * np.sqrt(np.log10(max(effective, 2.0)) / effective)
    quiet = np.abs(correlation[1:] / correlation[0]) < limit
    runs = np.flatnonzero(np.convolve(quiet, np.ones(_RUN), mode="valid") == _RUN)
    return int(runs[0]) if runs.size else centred_values.size


@dataclass(frozen=True, kw_only=True)
class TrackingMeasures:
    """Measures of tracking, which say nothing of how errors accumulate in the loop."""

    maximum_error: float  # Largest |x_m − x_c| over largest |x_c| [-]
    rms_error: float  # RMS of x_m − x_c over that of x_c [-]
    # Tracking indicator at the end of the test [m²]; positive when the measured displacement lags
    tracking_indicator: float
    phase_error: float  # Phase lag of the PAEI [rad]
    amplitude_error: float  # Amplitude error of the PAEI [-]
    # Energy that the tracking error added by the end of the test, over the largest strain energy of the
    # specimen [-]; with the recorded force, or that of a linear specimen
    energy_error: float
    of_recorded_force: bool  # Whether the energy is that of a recorded force
    delay_by_correlation: float  # Delay at which the cross-correlation is largest [s]


def measure_tracking(recording: Recording) -> TrackingMeasures:
    """Evaluate the measures of tracking of a test.

    >>> phase = np.linspace(0.0, 20.0 * np.pi, 20001)
    >>> found = measure_tracking(
    ...     Recording(command=np.sin(phase), measured=0.98 * np.sin(phase - 0.05), time_step=0.001)
    ... )
    >>> round(found.phase_error, 3), round(found.amplitude_error, 3), round(found.tracking_indicator, 2)
    (0.05, -0.02, 1.54)
    """
    command, measured_displacement = recording.command, recording.measured
    force = measured_displacement if recording.force is None else recording.force
    errors = phase_amplitude_errors(command, measured_displacement)
    largest_energy = 0.5 * float(np.abs(force * measured_displacement).max())
    return TrackingMeasures(
        maximum_error=maximum_tracking_error(command, measured_displacement),
        rms_error=rms_tracking_error(command, measured_displacement),
        tracking_indicator=float(tracking_indicator(command, measured_displacement)[-1]),
        phase_error=errors.phase,
        amplitude_error=errors.amplitude,
        energy_error=float(energy_error(command, measured_displacement, force)[-1]) / largest_energy,
        of_recorded_force=recording.force is not None,
        delay_by_correlation=delay_by_cross_correlation(command, measured_displacement, recording.time_step),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Windows:
    """Indices of overlapping windows in which the command moved."""

    centre: NDArray[np.float64]  # Middle of each window [s], shape (windows,)
    amplitude: NDArray[np.float64]  # amplitude, delay: A [-] and d [s], shape (windows,)
    delay: NDArray[np.float64]
    amplitude_sd: NDArray[np.float64]  # amplitude_sd, delay_sd: Their standard deviations, shape (windows,)
    delay_sd: NDArray[np.float64]
    length: float  # Length of a window [s]

    @property
    def delay_range(self) -> float:
        """Range of d over the windows beyond what noise explains [s]."""
        return _range(self.delay, self.delay_sd)

    @property
    def amplitude_range(self) -> float:
        """Range of A over the windows beyond what noise explains [-]."""
        return _range(self.amplitude, self.amplitude_sd)


def _range(values: NDArray[np.float64], deviations: NDArray[np.float64]) -> float:
    if values.size < 2:  # noqa: PLR2004 - one window has no range
        return 0.0
    low, high = values + _DEVIATIONS * deviations, values - _DEVIATIONS * deviations
    return max(float(high.max() - low.min()), 0.0)


def track_windows(recording: Recording, index_of_test: TrackingIndex) -> Windows:
    """Evaluate A and d in windows that overlap by half."""
    begins, size = _cuts(recording, index_of_test.plain.equivalent_frequency)
    energies = [float(np.var(recording.command[begin : begin + size])) for begin in begins]
    rows = []
    for begin, energy in zip(begins, energies, strict=True):
        window_index = None if energy < _QUIET * max(energies) else _track_window(recording, begin, size)
        if window_index is not None:
            centre = (begin + 0.5 * size) * recording.time_step
            rows.append((centre, window_index.amplitude, window_index.delay, *window_index.spread))
    columns = np.array(rows, dtype=np.float64).reshape(-1, 5).T
    names = ("centre", "amplitude", "delay", "amplitude_sd", "delay_sd")
    return Windows(**dict(zip(names, columns, strict=True)), length=size * recording.time_step)


def _cuts(recording: Recording, frequency: float) -> tuple[list[int], int]:
    """First samples of the windows, and their length in samples."""
    total = recording.command.size
    size = max(int(_PERIODS / (frequency * recording.time_step)), 2 * total // _MOST_WINDOWS, FEWEST_SAMPLES)
    count = 2 * total // size - 1
    if count < _FEWEST_WINDOWS:
        return [], size
    return np.linspace(0, total - size, count).astype(int).tolist(), size


def _track_window(recording: Recording, begin: int, size: int) -> TrackingIndex | None:
    """Index of one window; None where it has none, as where nothing moves."""
    stretch = slice(begin, begin + size)
    try:
        part = Recording(
            command=recording.command[stretch],
            measured=recording.measured[stretch],
            time_step=recording.time_step,
        )
        return track(part, draws=_DRAWS)
    except ReliabError:
        return None
