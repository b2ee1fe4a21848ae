"""Likelihood of what was recorded: residuals over time and frequency that are weighted by their variance.

Each kind of evidence gives a residual for a possible world. Its variance is estimated at the mode of the
posterior, so that whatever the sensors and the computer leave counts as noise.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy

from reliab.assessment.inference.cells import fit_variances
from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.equation_of_motion import residual
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.structure_response import respond
from reliab.core.arrays import Array, Spectrum
from reliab.structures.partition import Partition

_MAIN_POWER = 0.9  # of a command's power, that lies below its main frequencies
_REACH = 2.0  # times the main frequencies, up to which the equation of motion is weighed
_REACH_OF_GROUND = 3.0  # times the natural frequency, up to which a ground motion is taken to be smooth
_WEIGHT_OF_GROUND = 0.4  # of the likelihood: earthquakes are less smooth than noise (tests/benchmarks)
_POINTS = 1500  # of the integral of the determinant


@dataclass(kw_only=True, eq=False)
class Evidence(ABC):
    """One kind of evidence."""

    channels: ChannelSpectra
    partition: Partition
    weight: float = 1.0  # Of its logarithm of the likelihood
    _variance: Array = field(init=False)

    @cached_property
    def highest(self) -> float:
        """Highest frequency that is weighed [Hz]."""
        return _REACH * max(float(self.partition.natural_frequencies[0]), main_frequency(self.channels))

    @abstractmethod
    def spectrum(self, experiment: Experiment) -> Spectrum:
        """Residual of a possible world, shape (p, K)."""

    def cells(self, experiment: Experiment) -> Array:
        """Residual over time and frequency, shape (p, J, k)."""
        return self.channels.cells(self.spectrum(experiment), self.highest)

    def update(self, experiment: Experiment) -> None:
        """Estimate the variance of the residual anew."""
        cells = self.cells(experiment)
        found = np.stack([np.sum(fit_variances(row**2), axis=0) for row in cells])
        self._variance = np.maximum(found, self.noise[:, np.newaxis, np.newaxis])

    @property
    def noise(self) -> Array:
        """Variance of a coefficient that the displacement sensors' noise makes at least, shape (p,)."""
        stiffness = self.partition.specimen_stiffness @ self.channels.to_interface
        return np.asarray(stiffness**2 @ self.channels.noise * self.channels.band.noise_gain)

    def whitened(self, experiment: Experiment) -> Array:
        """Residual over its standard deviation, shape (m,)."""
        return np.asarray(np.sqrt(self.weight / self._variance) * self.cells(experiment)).ravel()

    def log_likelihood(self, experiment: Experiment) -> float:
        """Logarithm of the likelihood with the variances as estimated, but for a constant."""
        squares = self.cells(experiment) ** 2 / self._variance + np.log(self._variance)
        return -0.5 * self.weight * float(squares.sum()) - self.determinant(experiment)

    def determinant(self, experiment: Experiment) -> float:
        """Return what the logarithm of the likelihood loses beside the squares of the residual.

        The noise of the displacement sensors enters as forces of the specimen. A softer specimen, or a sensor
        of larger scale, would leave less of it to explain, so that both would be found where they are not
        (errors in variables: Fuller 1987, Measurement Error Models, 1.3). What that gains is taken away
        again, as far as the noise is that of sensors.
        """
        stiffness = (self.partition.specimen_stiffness @ self.channels.to_interface) ** 2
        of_sensors = stiffness * self.channels.noise
        total = np.maximum(of_sensors.sum(axis=1, keepdims=True), np.finfo(float).tiny)
        softer = np.log(experiment.share * experiment.frequency**2) - of_sensors / total @ np.log(
            experiment.scale
        )
        share = np.sum(self.noise[:, np.newaxis, np.newaxis] / self._variance, axis=(1, 2))
        return -self.weight * float(share @ softer)


@dataclass(kw_only=True, eq=False)
class EquationOfMotion(Evidence):
    """The equation of motion, against the recorded ground acceleration."""

    def spectrum(self, experiment: Experiment) -> Spectrum:
        """Residual of the equation [N]."""
        return residual(self.channels, self.partition, experiment)


@dataclass(kw_only=True, eq=False)
class ImpliedGroundMotion(Evidence):
    """The ground motion that a test with one actuator implies, which was not recorded but is broad-band.

    The record is then an autoregressive process. The determinant of the map from ground motion to command is
    that of the whole loop over the band; over all frequencies it would be constant (Kolmogorov's formula).
    """

    weight: float = _WEIGHT_OF_GROUND

    @cached_property
    def highest(self) -> float:
        """Highest frequency that is weighed [Hz]; below the second mode of a frame."""
        natural = self.partition.natural_frequencies
        beside = [float(np.sqrt(natural[0] * natural[1]))] if natural.size > 1 else []
        return min([_REACH_OF_GROUND * float(natural[0]), *beside])

    def spectrum(self, experiment: Experiment) -> Spectrum:
        """Implied ground acceleration times the mass that it moves [N]."""
        at_interface = residual(self.channels, self.partition, experiment)
        if self.partition.size == 1:
            return at_interface
        structure = experiment.structure(self.partition)
        response = respond(structure, self.channels.band.s)
        by_force = _moved_mass(structure) * response.compliance[:, 0, 0] / response.ground[:, 0]
        return np.asarray(by_force * at_interface)

    @cached_property
    def tracking(self) -> tuple[float, float]:
        """Gain [-] and delay [s] of the measured displacement."""
        command, tracked = self.channels.command[0], self.channels.tracked[0]
        angular, power = self.channels.band.s.imag, np.abs(command) ** 2
        gain = float(np.vdot(command, tracked).real / power.sum())
        turned = np.imag(tracked * np.conj(command))
        return gain, -float(np.sum(angular * turned) / np.sum(angular**2 * power))

    def determinant(self, experiment: Experiment) -> float:
        """Logarithm of the determinant, with its sign turned."""
        structure = experiment.structure(self.partition)
        blocks, columns = self._variance.shape[1:]
        hop = self.channels.hop * self.channels.band.time_step
        angular = np.linspace(0.0, np.pi * columns / hop, _POINTS)[1:]
        gain, delay = self.tracking
        lag = delay - float(experiment.skew[0]) + experiment.feedback_lag
        followed = gain / float(experiment.scale[0]) * np.exp(-1j * angular * lag)
        response = respond(structure, 1j * angular)
        moved = response.compliance[:, 0, 0] * response.impedance[:, 0, 0] * (1.0 - followed)
        loop = _moved_mass(structure) * (1.0 - moved) / response.ground[:, 0]
        of_frequencies = float(np.mean(np.log(np.abs(loop)))) * float(angular[-1])
        return float(-self.weight * blocks * hop / np.pi * of_frequencies)

    def concentration(self, experiment: Experiment) -> float:
        """Share of the implied motion's power that three neighbouring frequencies hold, whitened [-]."""
        history = self.channels.band.history(self.spectrum(experiment))[0]
        strength = np.sqrt(self._variance[0].mean(axis=-1))
        centre = (np.arange(strength.size) + 1.0) * self.channels.hop
        level = np.interp(np.arange(history.size), centre, strength)
        power = np.abs(scipy.fft.rfft(history / level * np.hanning(history.size))) ** 2
        step = 1.0 / (history.size * self.channels.band.time_step)
        frequency = np.arange(power.size) * step
        natural = float(self.partition.natural_frequencies[0])
        inside = (frequency > 0.3 * natural) & (frequency < self.highest)
        ratio = power[inside] / _smooth(power[inside], frequency[inside])
        largest = int(np.argmax(ratio))
        return float(ratio[max(largest - 1, 0) : largest + 2].sum() / ratio.sum())


def _moved_mass(structure: Partition) -> float:
    """Mass by which a ground acceleration acts at the interface at rest, h(0)/H(0) [kg]."""
    at_rest = respond(structure, np.zeros(1, dtype=np.complex128))
    return float((at_rest.ground[0, 0] / at_rest.compliance[0, 0, 0]).real)


def _smooth(power: Array, frequency: Array) -> Array:
    octave = np.log2(frequency)
    weight = np.exp(-0.5 * ((octave[:, np.newaxis] - octave) / 0.5) ** 2)
    return np.asarray(weight @ power / weight.sum(axis=1))


def main_frequency(channels: ChannelSpectra) -> float:
    """Frequency [Hz] below which most of the commands' power lies."""
    power = np.abs(channels.at_interface) ** 2
    total = np.cumsum(power / power.sum(axis=-1, keepdims=True), axis=-1).min(axis=0)
    place = int(np.searchsorted(total, _MAIN_POWER))
    return float(channels.band.s.imag[min(place, total.size - 1)] / (2.0 * np.pi))


@dataclass(kw_only=True, eq=False)
class SpecimenForce(Evidence):
    """The recorded force against that of the specimen as stated, Z x_m."""

    def spectrum(self, experiment: Experiment) -> Spectrum:
        """Return the recorded force less that of the specimen [N]."""
        force = experiment.force(self.channels)
        if force is None:
            raise AssertionError  # evidence of a force needs one
        impedance = experiment.structure(self.partition).impedance(self.channels.band.s)
        expected = np.einsum("kpq,qk->pk", impedance, experiment.reading(self.channels))
        return np.asarray(force - expected)
