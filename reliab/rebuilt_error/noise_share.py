"""What sensor noise adds to the mean square and the peak of a rebuilt error."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from reliab.rebuilt_error.error_statistics import mean_square
from reliab.rebuilt_error.noise import SensorNoise
from reliab.rebuilt_error.recursion import Recursion, respond
from reliab.rebuilt_error.whole_structure import WholeStructure

Array = NDArray[np.float64]

_PER_PERIOD = 64.0  # samples in a period of the highest mode while draws are swept
_NOISE_HISTORIES = 64
_NEGLIGIBLE = 1e-4  # share of the error that noise must exceed to be swept


@dataclass(frozen=True, kw_only=True, eq=False)
class NoiseShare:
    """What noise adds to the mean square and to the peak of an error.

    Attributes
    ----------
    white : float
        Expected share of white noise in the mean square [m²].
    in_square, in_peak : numpy.ndarray
        Drawn differences, observed minus true [m²] and [m], shape (draws,).
    deviation : float
        Root mean square of the noise in the error's history [m].
    """

    white: float
    in_square: Array
    in_peak: Array
    deviation: float

    @property
    def white_in_peak(self) -> float:
        """What white noise adds to the peak in the mean [m], by its share of the noise's power.

        What passes for slow noise may be the actuator's own doing, and is not taken away from a value.
        """
        power = self.deviation**2
        return float(self.in_peak.mean()) * self.white / power if power > 0.0 else 0.0


def share_of_noise(
    noise: SensorNoise, structure: WholeStructure, error: Array, generator: np.random.Generator
) -> NoiseShare:
    """Noise in the mean square and peak of a rebuilt error.

    Parameters
    ----------
    noise : SensorNoise
        The sensor's noise.
    structure : WholeStructure
        The structure, which filters it.
    error : numpy.ndarray
        Rebuilt x_m − x_I from smoothed histories [m], shape (n,).
    generator : numpy.random.Generator
        Source of the draws.

    Returns
    -------
    NoiseShare
        The shares; zero where they are negligible.
    """
    every = min(thinning(structure, noise.time_step), max(int(0.3 / (noise.band * noise.time_step)), 1))
    coarse = np.ascontiguousarray(error[::every])
    recursion = Recursion.of_displacement(structure, every * noise.time_step)
    points = fft.next_fast_len(2 * coarse.size, real=True)
    frequency = fft.rfftfreq(points, every * noise.time_step)
    density = noise.passed(frequency) / every
    amplitude = np.sqrt(0.5 * points * density)
    top, square = float(np.abs(coarse).max()), mean_square(coarse)
    in_square, in_peak, power = [], [], []
    for count in range(_NOISE_HISTORIES):
        normal = generator.standard_normal((2, amplitude.size))
        sample = fft.irfft((normal[0] + 1j * normal[1]) * amplitude, points)[: coarse.size]
        noisy = respond(recursion, sample)[0] - sample
        power.append(mean_square(noisy))
        if count == 0 and np.sqrt(power[0]) <= _NEGLIGIBLE * np.sqrt(square):
            return NoiseShare(white=0.0, in_square=np.zeros(1), in_peak=np.zeros(1), deviation=0.0)
        in_square.append(mean_square(coarse + noisy) - square)
        in_peak.append(float(np.abs(coarse + noisy).max()) - top)
    mean_power = float(np.mean(power))
    gain = np.abs(structure.error_transfer(2j * np.pi * frequency) - 1.0) ** 2
    white = gain * density * noise.weights[0] / noise.density(frequency)
    return NoiseShare(
        white=mean_power * float(white.sum() / (gain * density).sum()),
        in_square=np.array(in_square),
        in_peak=np.array(in_peak),
        deviation=float(np.sqrt(mean_power)),
    )


def thinning(structure: WholeStructure, time_step: float) -> int:
    """Return the number of samples of which one is enough while draws are swept."""
    highest = float(structure.natural_frequencies[-1])
    return max(int(1.0 / (_PER_PERIOD * highest * time_step)), 1)
