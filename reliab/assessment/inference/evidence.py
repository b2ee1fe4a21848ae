"""Likelihood of what was recorded: residuals over time and frequency that are weighted by their variance.

Each kind of evidence gives a residual for a possible world. Its variance is estimated at the mode of the
posterior, so that whatever the sensors and the computer leave counts as noise.

The response without actuator errors follows from the channels in two ways (`rebuilt`). Their difference,
turned into forces at the interface, is the residual ::

    r = H⁻¹ (x_c + h a) − Z (x_c − x_f)

Where the ground acceleration a was recorded, r is what noise of the sensors and of the integration leave.
Where it was not, r holds the forces H⁻¹h a by which the ground drove the structure. With several interface
displacements the one unknown a is eliminated, and the other equations remain (`EquationWithoutGround`). With
one, r is the force by which the ground drove one mass (of a frame, r H/h is its acceleration), and what is
known of it is that earthquakes are broad-band: smooth over frequency. The test is then as likely as an
autoregressive process with that innovation; its determinant is the second term of `ImpliedGroundMotion`.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.assessment.inference.cells import fit_excess, fit_variances
from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.structure_response import apply_at_interface, respond
from reliab.core.arrays import Array, Spectrum
from reliab.structures.partition import Partition

_LEAST_NOISE = 1e-6  # of a channel's motion, that its sensor's noise is taken to be at least
_SINGULAR = 1e-12  # of the noise's mean variance, that each mixture of it has at least
_ACCURACY = 3e-4  # of the specimen's force, that sampled channels and sensors leave at least
_MAIN_POWER = 0.9  # of a command's power, that lies below its main frequencies
_REACH = 2.0  # times the main frequencies, up to which the equation of motion is weighed
_REACH_OF_GROUND = 3.0  # times the natural frequency, up to which a ground motion is taken to be smooth
_WEIGHT_OF_GROUND = 0.4  # of the likelihood: earthquakes are less smooth than noise (tests/benchmarks)
_PLACES = 64  # at which a power is smoothed
_POINTS = 1500  # of the integral of the determinant
_FARTHEST = 3.0  # standard deviations of the stated frequency, that an unrecorded ground motion may show
_CONCENTRATION = 0.6  # of the power in three neighbouring frequencies: not broad-band
_NEGLIGIBLE = 0.01  # of the largest power, below which a frequency hardly takes part in a ground motion
_NARROWNESS = 0.8  # of the power at one time in two neighbouring frequencies: a sweep, not an earthquake
_LARGEST_MISFIT = 0.3  # of the forces, that one ground acceleration may leave unexplained


@dataclass(kw_only=True, eq=False)
class Evidence(ABC):
    """One kind of evidence."""

    farthest: float = np.inf  # Standard deviations of the stated frequency, beyond which it shows none

    @abstractmethod
    def whiten(self, experiment: Experiment) -> Array:
        """Residual of a possible world over its standard deviation, shape (m,)."""

    @abstractmethod
    def update(self, experiment: Experiment) -> None:
        """Estimate the variance of the residual anew, where it is not known."""

    def log_likelihood(self, experiment: Experiment) -> float:
        """Logarithm of the likelihood with the variances as estimated, but for a constant."""
        return -0.5 * float(np.sum(self.whiten(experiment) ** 2)) - self.determinant(experiment)

    def determinant(self, experiment: Experiment) -> float:  # noqa: ARG002 - which one kind asks
        """Return what the logarithm of the likelihood loses beside the squares of the residual."""
        return 0.0

    def holds(self, experiment: Experiment) -> bool:  # noqa: ARG002 - which some kinds ask
        """Whether what this evidence assumes of the test holds, by the most probable world."""
        return True


@dataclass(kw_only=True, eq=False)
class EvidenceOfChannels(Evidence):
    """A residual over time and frequency."""

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
        power = self.cells(experiment) ** 2
        self._variance = np.stack([np.sum(fit_variances(row), axis=0) for row in power])

    def whiten(self, experiment: Experiment) -> Array:
        """Residual over its standard deviation, shape (m,)."""
        return np.asarray(np.sqrt(self.weight / self._variance) * self.cells(experiment)).ravel()

    def log_likelihood(self, experiment: Experiment) -> float:
        """Logarithm of the likelihood with the variances as estimated, but for a constant."""
        return super().log_likelihood(experiment) - 0.5 * self.weight * float(np.log(self._variance).sum())


@dataclass(kw_only=True, eq=False)
class BalanceOfForces(EvidenceOfChannels):
    """Forces at the interface whose balance only the sensors' noise disturbs.

    Noise of one sensor disturbs the balance at several displacements. Balances are therefore mixed, at every
    frequency, such that with the structure as stated the noise has variance one in each residual and no
    covariance between them.
    """

    # Share of the sensors' noise in the variance, shape (rows, J, k); None before it is known
    _share: Array | None = field(init=False, default=None)
    _level: Array = field(init=False)  # `noise_level` where the variance was estimated
    # Sum over time of the share, times how far the power is below the variance [-], shape (rows, 1, k)
    _missed: Array = field(init=False)

    @abstractmethod
    def forces(self, experiment: Experiment) -> Spectrum:
        """Return the forces that are not balanced in a possible world [N], shape (p, K)."""

    def balance(self, forces: Spectrum, structure: Partition) -> Spectrum:  # noqa: ARG002 - which some need
        """Turn forces at the interface, shape (K, p, n), into balances, shape (K, rows, n)."""
        return forces

    def spectrum(self, experiment: Experiment) -> Spectrum:
        """Residuals over the deviation of their noise [-], shape (rows, K)."""
        forces = self.forces(experiment).T[..., np.newaxis]
        balances = self.balance(forces, experiment.structure(self.partition))
        return np.asarray((self._unmix @ balances)[..., 0].T)

    @cached_property
    def _noise(self) -> Spectrum:
        """Balances of the stated structure by noise of each sensor, of deviation one, shape (K, rows, p)."""
        impedance = self.partition.impedance(self.channels.band.s) @ self.channels.to_interface
        motion = self.channels.band.history(self.channels.measured).std(axis=-1)
        variances = self.channels.noise * self.channels.band.noise_gain + (_LEAST_NOISE * motion) ** 2
        return self.balance(impedance * np.sqrt(variances), self.partition)

    @cached_property
    def _unmix(self) -> Spectrum:
        covariance = self._noise @ np.conj(np.swapaxes(self._noise, 1, 2))
        size = np.trace(covariance, axis1=1, axis2=2).real / covariance.shape[1]
        covariance = covariance + (_SINGULAR * size)[:, np.newaxis, np.newaxis] * np.eye(covariance.shape[1])
        return np.asarray(np.linalg.inv(np.linalg.cholesky(covariance)))

    @cached_property
    def _sensor_shares(self) -> Array:
        """Share of each sensor in the noise of each residual, by columns of cells, shape (k, rows, p)."""
        return np.asarray(np.abs(self._unmix[self._places] @ self._noise[self._places]) ** 2)

    @cached_property
    def _places(self) -> NDArray[np.int64]:
        """Places of the columns of cells among the frequencies of the band."""
        columns = self._motion.shape[-1]
        frequencies = (np.arange(columns) + 0.5) / (2.0 * self.channels.hop * self.channels.band.time_step)
        places = np.searchsorted(self.channels.band.s.imag, 2.0 * np.pi * frequencies)
        return np.minimum(places, len(self._noise) - 1)

    @cached_property
    def _motion(self) -> Array:
        """Power of the specimen's forces, mixed like balances, shape (rows, J, k)."""
        impedance = self.partition.impedance(self.channels.band.s)
        force = apply_at_interface(impedance, self.channels.to_interface @ self.channels.measured)
        mixed = self._unmix @ self.balance(force.T[..., np.newaxis], self.partition)
        power = self.channels.cells(mixed[..., 0].T, self.highest) ** 2
        return np.stack([np.sum(fit_variances(row), axis=0) for row in power])

    def _stiffening(self, experiment: Experiment) -> Array:
        """Logarithm of the forces by the sensors' noise over those in the stated structure, (rows, 1, k)."""
        stiffness = np.log(experiment.share * experiment.frequency**2)
        return np.asarray((stiffness - self._sensor_shares @ np.log(experiment.scale)).T[:, np.newaxis])

    def noise_level(self, experiment: Experiment, share: Array) -> Array:
        """Logarithm of the noise in a world over that in the stated structure, shape (rows, J, k).

        `share`: of the displacement sensors in the variance of the residual [-].
        """
        return share * self._stiffening(experiment)

    def cells(self, experiment: Experiment) -> Array:
        """Residual over time and frequency, shape (rows, J, k), in units of its noise in this world.

        A softer specimen, or a sensor of larger scale, leaves less noise to explain, so that both would be
        found where they are not if all residuals were divided by the same deviation (errors in variables:
        Fuller 1987, Measurement Error Models, 1.3).
        """
        cells = super().cells(experiment)
        if self._share is None:
            return cells
        return np.asarray(cells * np.exp(self._level - self.noise_level(experiment, self._share)))

    def update(self, experiment: Experiment) -> None:
        """Estimate the variance of the residual anew, and what is noise of it."""
        self._share = None
        power, stiffening = self.cells(experiment) ** 2, self._stiffening(experiment)
        noise = np.broadcast_to(np.exp(2.0 * stiffening), power.shape)
        self._variance = np.stack(
            [fit_excess(*rows, _ACCURACY**2) for rows in zip(power, noise, self._motion, strict=True)]
        )
        self._share = noise / self._variance
        self._missed = np.sum(self._share * (1.0 - power / self._variance), axis=1, keepdims=True)
        self._level = self.noise_level(experiment, self._share)

    def determinant(self, experiment: Experiment) -> float:
        """Correct the likelihood for the error of the estimated variance.

        Its slope at the true world is then zero on average (Nakamura 1990, Biometrika 77, 127).
        """
        return -self.weight * float(np.sum(self._missed * self._stiffening(experiment)))

    def log_likelihood(self, experiment: Experiment) -> float:
        """Logarithm of the likelihood with the variances as estimated, but for a constant."""
        return super().log_likelihood(experiment) + self.weight * float(self._level.sum())


def residual(
    channels: ChannelSpectra, partition: Partition, experiment: Experiment, force: Spectrum | None = None
) -> Spectrum:
    """Residual of the equation of motion [N], shape (p, K).

    `force` of the specimen [N], by default that of the stated one along the measured displacement.
    """
    response = respond(experiment.structure(partition), channels.band)
    command = channels.interface_command
    ground = experiment.ground(channels)
    driven = command if ground is None else command + response.ground.T * ground
    foreseen = command
    if experiment.integration:
        square = (channels.band.s * channels.band.record_step) ** 2
        foreseen = command - experiment.integration * square * command
    if force is None:
        difference = foreseen - experiment.late(experiment.reading(channels), channels)
        acting = apply_at_interface(response.impedance, difference)
    else:
        acting = apply_at_interface(response.impedance, foreseen) - experiment.late(force, channels)
    if experiment.slip is not None:
        acting = acting + apply_at_interface(response.impedance, experiment.slip)
    return np.asarray(apply_at_interface(response.stiffness, driven) - acting)


@dataclass(kw_only=True, eq=False)
class EquationOfMotion(BalanceOfForces):
    """The equation of motion, against the recorded ground acceleration."""

    def forces(self, experiment: Experiment) -> Spectrum:
        """Residual of the equation [N], shape (p, K)."""
        return residual(self.channels, self.partition, experiment)


@dataclass(frozen=True, eq=False)
class _Grid:
    s: Spectrum  # [rad/s]


_STATIC_GRID = _Grid(np.zeros(1, dtype=np.complex128))


@dataclass(kw_only=True, eq=False)
class ImpliedGroundMotion(EvidenceOfChannels):
    """The ground motion that a test with one actuator implies, which was not recorded but is broad-band.

    The record is then an autoregressive process. The determinant of the map from ground motion to command is
    that of the whole loop over the band; over all frequencies it would be constant (Kolmogorov's formula).
    """

    weight: float = _WEIGHT_OF_GROUND
    farthest: float = _FARTHEST

    @cached_property
    def highest(self) -> float:
        """Highest frequency that is weighed [Hz], below what the interface does not see between two modes."""
        natural = self.partition.natural_frequencies
        mean_frequency = [float(np.sqrt(natural[0] * natural[1]))] if natural.size > 1 else []
        return min([_REACH_OF_GROUND * float(natural[0]), *mean_frequency])

    def spectrum(self, experiment: Experiment) -> Spectrum:
        """Return the implied ground acceleration times the mass that it moves at rest [N]."""
        interface_residual = residual(self.channels, self.partition, experiment)
        if self.partition.size == 1:
            return interface_residual
        structure = experiment.structure(self.partition)
        moved_mass = respond(structure, self.channels.band).ground_load
        return np.asarray(_mass_at_rest(structure) / moved_mass[:, 0] * interface_residual)

    @cached_property
    def tracking(self) -> tuple[float, float]:
        """Gain [-] and delay [s] of the measured displacement."""
        command, tracked_command = self.channels.command[0], self.channels.tracked[0]
        angular, power = self.channels.band.s.imag, np.abs(command) ** 2
        gain = float(np.vdot(command, tracked_command).real / power.sum())
        quadrature = np.imag(tracked_command * np.conj(command))
        return gain, -float(np.sum(angular * quadrature) / np.sum(angular**2 * power))

    @cached_property
    def _grid(self) -> _Grid:
        highest = self._variance.shape[-1] / (2.0 * self.channels.hop * self.channels.band.time_step)
        return _Grid(2j * np.pi * np.linspace(0.0, highest, _POINTS)[1:])

    def determinant(self, experiment: Experiment) -> float:
        """Logarithm of the determinant, with its sign turned."""
        structure, angular = experiment.structure(self.partition), self._grid.s.imag
        gain, delay = self.tracking
        lag = delay - float(experiment.skew[0]) + experiment.feedback_lag
        actuator_transfer = gain / float(experiment.scale[0]) * np.exp(-1j * angular * lag)
        response = respond(structure, self._grid)
        loop = np.abs(response.stiffness[:, 0, 0] - response.impedance[:, 0, 0] * (1.0 - actuator_transfer))
        if self.partition.size > 1:
            loop *= _mass_at_rest(structure) / np.abs(response.ground_load[:, 0])
        log_determinant = float(np.mean(np.log(loop)) * angular[-1])
        blocks, hop = self._variance.shape[1], self.channels.hop * self.channels.band.time_step
        return float(-self.weight * blocks * hop / np.pi * log_determinant)

    def holds(self, experiment: Experiment) -> bool:
        """Whether the implied ground motion is that of an earthquake, which shows a frequency."""
        is_harmonic = self.concentration(experiment) >= _CONCENTRATION
        return not is_harmonic and self._narrowness(experiment) < _NARROWNESS

    def _narrowness(self, experiment: Experiment) -> float:
        """Share of the implied motion's power at one time that two neighbouring frequencies hold [-].

        Close to one for a sweep, which passes all frequencies, but one after the other.
        """
        highest = _REACH_OF_GROUND * float(self.partition.natural_frequencies[0])
        power = self.channels.cells(self.spectrum(experiment), highest)[0] ** 2
        mean = power.mean(axis=0)
        power = power / (mean + _NEGLIGIBLE * mean.max() + np.finfo(float).tiny)
        return float((power[:, :-1] + power[:, 1:]).max(axis=1).sum() / max(power.sum(), 1.0))

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
        is_inside = (frequency > 0.3 * natural) & (frequency < self.highest)
        ratio = power[is_inside] / _smooth(power[is_inside], frequency[is_inside])
        largest = int(np.argmax(ratio))
        return float(ratio[max(largest - 1, 0) : largest + 2].sum() / ratio.sum())


@dataclass(kw_only=True, eq=False)
class EquationWithoutGround(EquationOfMotion):
    """The equations of motion of several interface displacements, without the ground acceleration they share.

    With residuals r and loads g = H⁻¹h it is eliminated by the displacement k that it loads most:
    q_i = g_k r_i − g_i r_k for all others.
    """

    @cached_property
    def _size(self) -> Array:
        """Size of the specimen's force at each interface displacement [N], shape (p,)."""
        moved = self.channels.band.history(self.channels.to_interface @ self.channels.measured)
        force = self.partition.specimen_stiffness @ moved
        return np.asarray(np.maximum(force.std(axis=1), np.finfo(float).tiny))

    @cached_property
    def _most_loaded(self) -> int:
        """Place of the displacement that the ground loads most at rest."""
        load = respond(self.partition, _STATIC_GRID).ground_load[0].real
        return int(np.argmax(np.abs(load) / self._size))

    def balance(self, forces: Spectrum, structure: Partition) -> Spectrum:
        """Eliminate the ground acceleration, which leaves balances of shape (K, p − 1, n) [kg N]."""
        load = respond(structure, self.channels.band).ground_load[..., np.newaxis]
        most = [self._most_loaded]
        balances = load[:, most] * forces - load * forces[:, most]
        return np.asarray(np.delete(balances, self._most_loaded, axis=1))

    def holds(self, experiment: Experiment) -> bool:
        """Whether one ground acceleration explains the forces at all interface displacements."""
        size = self._size[:, np.newaxis]
        forces = self.forces(experiment) / size
        load = respond(experiment.structure(self.partition), self.channels.band).ground_load.T / size
        load = load / np.linalg.norm(load, axis=0)
        unexplained = load[self._most_loaded] * forces - load * forces[self._most_loaded]
        left, whole = (self.channels.cells(row, self.highest) for row in (unexplained, forces))
        return bool(np.sum(left**2) <= _LARGEST_MISFIT**2 * np.sum(whole**2))


def _mass_at_rest(structure: Partition) -> float:
    """Return the force that holds the interface against a steady unit ground acceleration [kg]."""
    return float(respond(structure, _STATIC_GRID).ground_load[0, 0].real)


def _smooth(power: Array, frequency: Array) -> Array:
    octave = np.log2(frequency)
    places = np.linspace(octave[0], octave[-1], _PLACES)
    weight = np.exp(-0.5 * ((places[:, np.newaxis] - octave) / 0.5) ** 2)
    return np.asarray(np.interp(octave, places, weight @ power / weight.sum(axis=1)))


def main_frequency(channels: ChannelSpectra) -> float:
    """Frequency [Hz] below which most of the commands' power lies."""
    power = np.abs(channels.interface_command) ** 2
    total = np.cumsum(power / (power.sum(axis=-1, keepdims=True) + np.finfo(float).tiny), axis=-1).min(axis=0)
    place = int(np.searchsorted(total, _MAIN_POWER))
    return float(channels.band.s.imag[min(place, total.size - 1)] / (2.0 * np.pi))


@dataclass(kw_only=True, eq=False)
class EquationWithForce(EvidenceOfChannels):
    """The equation of motion with the recorded force of any specimen, against the ground acceleration."""

    def spectrum(self, experiment: Experiment) -> Spectrum:
        """Residual of the equation [N], shape (p, K)."""
        return residual(self.channels, self.partition, experiment, experiment.force(self.channels))


@dataclass(kw_only=True, eq=False)
class SpecimenForce(BalanceOfForces):
    """The recorded force against that of the specimen as stated, Z x_m.

    What is not noise of the displacement sensors is that of the load cell, which its scale divides.
    """

    def forces(self, experiment: Experiment) -> Spectrum:
        """Return the recorded force less that of the specimen [N], shape (p, K)."""
        force = experiment.force(self.channels)
        if force is None:
            raise AssertionError  # evidence of a force needs one
        impedance = experiment.structure(self.partition).impedance(self.channels.band.s)
        return np.asarray(force - apply_at_interface(impedance, experiment.reading(self.channels)))

    def noise_level(self, experiment: Experiment, share: Array) -> Array:
        """Logarithm of the noise of displacement sensors and load cell, over that as stated."""
        sensors = super().noise_level(experiment, share)
        load_cells = self._load_cell_shares @ np.log(experiment.force_scale)
        return np.asarray(sensors - (1.0 - share) * load_cells.T[:, np.newaxis])

    @cached_property
    def _load_cell_shares(self) -> Array:
        """Share of each load cell in its noise of each residual, by columns of cells, shape (k, rows, p)."""
        carry, impedance = self.channels.to_interface, self.partition.impedance(self.channels.band.s)
        forces = carry.T @ apply_at_interface(impedance, carry @ self.channels.measured)
        noise = np.linalg.inv(carry.T) * self.channels.band.history(forces).std(axis=-1)
        power = np.abs(self._unmix[self._places] @ noise) ** 2 + np.finfo(float).tiny
        return np.asarray(power / power.sum(axis=-1, keepdims=True))
