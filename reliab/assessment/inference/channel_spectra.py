"""Channels of a test in its analysis band: spectra, noise of the sensors, what their faults would add."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from reliab.assessment.inference.band import AnalysisBand, highest_frequency
from reliab.assessment.rebuilt_error.readings import lag_of_reading
from reliab.core.arrays import Array, Spectrum
from reliab.signals.noise import converter_step
from reliab.signals.spectra import analyse, synthesise
from reliab.structures.partition import Partition

_BLOCK = 1.0  # periods of the structure in a hop of the lapped transform
_SMALLEST_HOP = 4
_TAIL = (1.25, 0.95)  # of the band's edge and of the Nyquist frequency: between them noise is read
_FEWEST_BINS = 16
_COLLINEAR = 1e-6  # of the largest singular value, below which a sine gives gain and curvature alike
_MEANS = 3.0  # standard errors
# Of a sensor's hysteresis over the span, at which its effect is computed; between them it is interpolated
_WIDTHS = np.array([0.0, 2e-4, 5e-4, 1e-3, 2e-3, 4e-3, 8e-3])
_LEAST_NOISE = 1e-9  # of a channel's motion: sensors with less are taken to have that much


@dataclass(frozen=True, kw_only=True, eq=False)
class NoiseLeft:
    """Noise that is left in measured displacements after they were freed of it."""

    cells: Array  # Standard deviation over time and frequency, of mixtures of the channels [-], (p, J, hop)
    unmixing: Array  # Channels by mixtures [m], shape (p, p)
    # What one standard deviation of each coefficient, by which a channel follows the commands, would add, as
    # far as noise leaves these open [m], shape (p, 3 p, K)
    follows: Spectrum


@dataclass(frozen=True, kw_only=True, eq=False)
class ChannelSpectra:
    """Channels of a test with p actuators on the frequencies of its band, shape (p, K).

    Sensors stand at the actuators; `to_interface` turns their displacements into those of the interface.
    """

    band: AnalysisBand
    hop: int  # Coarse samples from one block of the lapped transform to the next
    command: Spectrum
    measured: Spectrum  # As the sensors read it
    tracked: Spectrum  # The same, its difference from the command freed of the sensors' noise
    noise_left: NoiseLeft  # Noise that is left in `tracked`
    noise: Array  # Variance of a sample of the displacement sensors' noise [m²], shape (p,)
    constant: Spectrum  # Of a channel that is 1 throughout, shape (K,)
    ramp: Spectrum  # Of one that rises from −½ to ½ over the record
    follows: Spectrum  # The part that follows the commands by constant gains, delays and curvatures [m]
    to_interface: Array  # Interface displacements of unit displacements at the actuators [-], shape (p, p)
    offset_size: Array  # Standard deviation of the offset that the readings may have [m], shape (p,)
    drift_size: Array  # Size of its rise over the test [m], shape (p,)
    initial_size: float  # Size of the error with which a record that begins in motion may begin [m]
    ground: Spectrum | None = None  # Ground acceleration [m/s²], shape (K,)
    force: Spectrum | None = None  # Recorded forces at the actuators [N], shape (p, K)
    # Displacement of the interface that the channels do not hold: that in which it stood before the record,
    # less what the command answered it with [m], shape (p,)
    standing: Array | float = 0.0

    @classmethod
    def from_channels(
        cls,
        command: Array,
        measured_displacement: Array,
        time_step: float,
        partition: Partition,
        *,
        ground: Array | None = None,
        force: Array | None = None,
        interface_matrix: Array | None = None,
        resolution: float = 0.0,
        offset_size: Array | None = None,
        initial_size: float = 0.0,
        standing: Array | float = 0.0,
    ) -> "ChannelSpectra":
        """Transform channels [m, m/s², N] on the record's grid, shape (p, n).

        `interface_matrix`: the identity by default; `resolution`: step of the converters of the measured
        displacements [m], where the readings do not show it; `offset_size`, `initial_size`, `standing`: as
        of the class, zero by default.
        """
        frequencies, ratios, _ = partition.modes
        lowest = float(frequencies[0])
        band = AnalysisBand.choose(
            samples=command.shape[-1],
            time_step=time_step,
            lowest=lowest,
            highest=highest_frequency(command, time_step, lowest),
            decay=float(np.min(2.0 * np.pi * frequencies * ratios)),
        )
        hop = max(2 * round(0.5 * _BLOCK / (lowest * band.time_step)), _SMALLEST_HOP)
        noise = np.array(
            [
                max(white_noise(row, time_step, band.flat), rounding_noise(row, resolution))
                for row in measured_displacement
            ]
        )
        places = np.linspace(-0.5, 0.5, command.shape[-1])
        command_spectrum, read = band.spectrum(command), band.spectrum(measured_displacement)
        follows, directions = _follow(command_spectrum, read, band)
        tracked_spectrum, noise_left = _remove_noise(band, follows, directions, read, noise, hop)
        drift = np.abs(_rises_of_difference(command, measured_displacement, time_step))
        return cls(
            band=band,
            hop=hop,
            command=command_spectrum,
            measured=read,
            tracked=tracked_spectrum,
            noise_left=noise_left,
            noise=noise,
            constant=band.spectrum(np.ones(command.shape[-1])),
            ramp=band.spectrum(places),
            follows=follows,
            to_interface=np.eye(len(command)) if interface_matrix is None else interface_matrix,
            offset_size=np.zeros(len(command)) if offset_size is None else offset_size,
            drift_size=drift + _MEANS * np.sqrt(12.0 * noise / command.shape[-1]),
            initial_size=initial_size,
            ground=None if ground is None else band.spectrum(ground),
            force=None if force is None else band.spectrum(force),
            standing=standing,
        )

    def hysteresis_lag(self, width: Array) -> Spectrum:
        """By how much sensors lag behind their motion [m], shape (p, K).

        `width` of their hysteresis over the span [-], shape (p,).
        """
        place = np.clip(np.searchsorted(_WIDTHS, width) - 1, 0, _WIDTHS.size - 2)
        actuators = np.arange(width.size)
        share = (width - _WIDTHS[place]) / (_WIDTHS[place + 1] - _WIDTHS[place])
        low, high = self._hysteresis_lags[place, actuators], self._hysteresis_lags[place + 1, actuators]
        return np.asarray(low + share[:, np.newaxis] * (high - low))

    @cached_property
    def _hysteresis_lags(self) -> Spectrum:
        """The same at each of the widths, shape (widths, p, K), along what follows the commands."""
        motion = self.band.full_history(self.follows)
        lags = [width * np.apply_along_axis(lag_of_reading, -1, motion, width) for width in _WIDTHS]
        return self.band.spectrum(np.array(lags))

    def draw_noise(self, generator: np.random.Generator) -> Spectrum:
        """Draw the noise that may be left in `tracked` [m], shape (p, K)."""
        left = self.noise_left
        cells = left.cells * generator.standard_normal(left.cells.shape)
        follows = generator.standard_normal(left.follows.shape[:2])
        rest = left.unmixing @ synthesise(cells, self.band.samples)
        return np.asarray(self.band.coarse_spectrum(rest) + np.einsum("pc,pck->pk", follows, left.follows))

    @cached_property
    def columns(self) -> int:
        """Number of frequencies of the lapped transform within the band."""
        return max(int(2.0 * self.hop * self.band.time_step * self.band.flat), 2)

    @cached_property
    def interface_command(self) -> Spectrum:
        """Commands of the interface displacements [m]."""
        return np.asarray(self.to_interface @ self.command)

    def force_at_interface(self, forces: Spectrum) -> Spectrum:
        """Return the forces on the interface displacements [N] that do the work of those at the actuators."""
        return np.asarray(np.linalg.solve(self.to_interface.T, forces))

    def cells(self, spectra: Spectrum, highest: float | None = None) -> Array:
        """Coefficients over time and frequency of histories, shape (p, J, k), without the record's ends.

        `highest`: frequency [Hz] above which none are wanted.
        """
        columns = self.columns
        if highest is not None:
            columns = min(columns, max(round(2.0 * self.hop * self.band.time_step * highest), 2))
        rows = [analyse(row, self.hop)[1:-2, :columns] for row in self.band.history(spectra)]
        return np.stack(rows)


def white_noise(values: Array, time_step: float, edge: float) -> float:
    """Variance of a sample of white noise, read above the frequency [Hz] above which there is no motion."""
    taper = np.hanning(values.size)
    power = np.abs(scipy.fft.rfft((values - values.mean()) * taper)) ** 2 / np.sum(taper**2)
    nyquist = 0.5 / time_step
    begin, end = _TAIL[0] * edge, _TAIL[1] * nyquist
    frequency = np.arange(power.size) / (values.size * time_step)
    tail = power[(frequency > begin) & (frequency < end)]
    if tail.size < _FEWEST_BINS:
        tail = power[frequency > 0.8 * nyquist]
    return float(np.median(tail) / np.log(2.0))


def rounding_noise(values: Array, resolution: float) -> float:
    """Variance of a sample of white noise that is as strong as rounding is within a slow motion's band.

    `resolution`: step of the converter where the readings do not show it. Rounding errors repeat from step to
    step: their power, Δ²/12, lies below the frequency at which readings change.
    """
    step = max(converter_step(values), resolution)
    changes = int(np.count_nonzero(np.diff(values))) + 1
    return step**2 / 12.0 * max(0.5 * values.size / changes, 1.0)


def _remove_noise(
    band: AnalysisBand,
    follows: Spectrum,
    directions: Spectrum,
    measured_displacement: Spectrum,
    noise: Array,
    hop: int,
) -> tuple[Spectrum, "NoiseLeft"]:
    """Free measured displacements of the sensors' noise.

    What follows the commands by constant gains, delays and curvatures is kept whole: it is coherent with the
    commands, so that its loss where the motion is weak would look like damping. The rest passes Wiener's
    filter over time and frequency. Several channels are mixed before it such that neither their noise nor
    their rest has a covariance between them: what two parallel actuators do alike cancels in the rotation.
    Returns also the noise that is left. `follows`, `directions`: see :func:`_follow`.
    """
    rest = band.history(measured_displacement - follows)
    deviation = np.sqrt(noise * band.noise_gain)
    least = _LEAST_NOISE * band.history(measured_displacement).std(axis=-1) + np.finfo(float).tiny
    mixing, unmixing = _mix(rest, np.maximum(deviation, least))
    cells = np.stack([analyse(row, hop) for row in mixing @ rest])
    columns = max(int(2.0 * hop * band.time_step * band.flat), 2)
    power = scipy.ndimage.gaussian_filter(cells[..., :columns] ** 2, (0.0, 1.5, 0.8), mode="nearest")
    gain = np.zeros_like(cells)
    gain[..., :columns] = np.maximum(1.0 - 1.0 / np.maximum(power, np.finfo(float).tiny), 0.0)
    smooth_part = unmixing @ synthesise(cells * gain, band.samples)
    noise_left = NoiseLeft(
        cells=np.sqrt(gain),
        unmixing=unmixing,
        follows=deviation[:, np.newaxis, np.newaxis] * directions,
    )
    return follows + band.coarse_spectrum(smooth_part), noise_left


def _mix(rest: Array, deviation: Array) -> tuple[Array, Array]:
    """B and its inverse, with noise of unit variance in each row of B times the channels, each (p, p).

    `rest`: what does not follow the commands [m], shape (p, m); `deviation` of the noise [m], shape (p,).
    """
    scaled = rest / deviation[:, np.newaxis]
    _, vectors = np.linalg.eigh(scaled @ scaled.T)
    return vectors.T / deviation, deviation[:, np.newaxis] * vectors


def _follow(
    command: Spectrum, measured_displacement: Spectrum, band: AnalysisBand
) -> tuple[Spectrum, Spectrum]:
    """Least squares of measured displacements on the commands and their first two derivatives, over time.

    Returns also the directions in which noise of unit variance at the coarse samples moves the result, shape
    (3 p, K).
    """
    scale = np.sqrt(np.sum(np.abs(band.s * command) ** 2) / np.sum(np.abs(command) ** 2))
    basis = np.concatenate([command, band.s / scale * command, (band.s / scale) ** 2 * command])
    shapes, sizes, components = np.linalg.svd(band.history(basis), full_matrices=False)
    inverse = np.where(sizes > _COLLINEAR * sizes[0], 1.0 / np.maximum(sizes, np.finfo(float).tiny), 0.0)
    directions = (shapes * inverse).T @ basis  # whose histories are the orthonormal rows of `components`
    return np.asarray(band.history(measured_displacement) @ components.T @ directions), directions


def _rises_of_difference(command: Array, measured_displacement: Array, time_step: float) -> Array:
    """Rise over the test [m] of measured minus command, beside a gain, a delay and a constant, shape (p,)."""
    place, rises = np.linspace(-0.5, 0.5, command.shape[-1]), []
    for row, read in zip(command, measured_displacement, strict=True):
        basis = np.stack([row, np.gradient(row, time_step), np.ones_like(place), place])
        size = np.abs(basis).max(axis=1, keepdims=True) + np.finfo(float).tiny
        scaled_basis = basis / size
        normal, right = scaled_basis @ scaled_basis.T, scaled_basis @ (read - row)
        rises.append(float(np.linalg.lstsq(normal, right, rcond=1e-12)[0][-1] / size[-1, 0]))
    return np.array(rises)
