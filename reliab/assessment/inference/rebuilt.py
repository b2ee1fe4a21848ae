"""The error of a test of a linear structure in one possible world.

Subtracting the equation of motion of the undisturbed structure from that of the test leaves, for a linear
structure and any actuator, with H, h and Z of `structure_response` ::

    e = H Z (x_c − x_f)        error of the command
    x_I = x_c − e              response without actuator errors
    x_m − x_I = e − (x_c − x_m)

with x_f the displacement whose force the loop received. The ground acceleration a gives the same response by
another way, x_I = −h a; the difference of the two is what `EquationOfMotion` weighs.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from reliab.assessment.inference.band import AnalysisBand
from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.structure_response import StructureResponse, apply_at_interface, respond
from reliab.core.arrays import Array, Spectrum
from reliab.structures.partition import Partition


@dataclass(frozen=True, kw_only=True, eq=False)
class RebuiltResponse:
    """Responses of the interface in one possible world, shape (p, K)."""

    exact: Spectrum  # x_I [m]
    displacement: Spectrum  # x_m [m]
    response: StructureResponse

    @property
    def error(self) -> Spectrum:
        """x_m − x_I [m]."""
        return np.asarray(self.displacement - self.exact)


def rebuild(channels: ChannelSpectra, partition: Partition, experiment: Experiment) -> RebuiltResponse:
    """Rebuild the response that the test would have had without actuator errors."""
    structure = experiment.structure(partition)
    response = respond(structure, channels.band)
    displacement = experiment.displacement(channels)
    difference = channels.interface_command - experiment.late(displacement, channels)
    error = apply_at_interface(response.compliance, apply_at_interface(response.impedance, difference))
    if experiment.initial_displacement or experiment.initial_velocity:
        error = error + channels.band.from_laplace(_free_vibration(structure, experiment, channels.band.s))
    standing_part = np.multiply.outer(channels.standing, channels.constant)
    return RebuiltResponse(
        exact=channels.interface_command - error, displacement=displacement + standing_part, response=response
    )


def error_of_command(structure: Partition, band: AnalysisBand, difference: Array) -> Array:
    """Error x_c − x_I [m] that a history of x_c − x_f at the interface [m] causes, both shape (p, n)."""
    response = respond(structure, band)
    forces = apply_at_interface(response.impedance, band.spectrum(np.atleast_2d(difference)))
    return band.full_history(apply_at_interface(response.compliance, forces))


def _free_vibration(structure: Partition, experiment: Experiment, s: Spectrum) -> Spectrum:
    """Laplace transform of an error of the command [m s], (p, K), that dies out in the lowest mode."""
    frequencies, ratios, shapes = structure.modes
    omega, ratio = 2.0 * np.pi * float(frequencies[0]), float(ratios[0])
    begin, rate = experiment.initial_displacement, omega * experiment.initial_velocity
    decaying = ((s + 2.0 * ratio * omega) * begin + rate) / (s**2 + 2.0 * ratio * omega * s + omega**2)
    shape = shapes[:, 0] / np.abs(shapes[:, 0]).max()
    return np.asarray(shape[:, np.newaxis] * decaying)


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearTest:
    """Errors of a test of a linear structure, by transfer functions; solutions are spectra, (2, p, K)."""

    channels: ChannelSpectra
    partition: Partition  # As stated
    evidence: ClassVar[None] = None  # That of all channels

    @cached_property
    def places(self) -> Array:
        """Numbers of the record's samples between those of `histories`, shape (n,)."""
        band = self.channels.band
        return np.asarray(np.arange(band.record_samples) * (band.record_step / band.time_step))

    def solve(self, world: Experiment, draw: int | None = None) -> Spectrum:  # noqa: ARG002 - nothing else is drawn
        """x_m − x_I and x_I [m] in a possible world."""
        rebuilt = rebuild(self.channels, self.partition, world)
        return np.stack([rebuilt.error, rebuilt.exact])

    def histories(self, solution: Spectrum) -> Array:
        """Both at the samples that hold the motion, shape (2, p, m)."""
        return self.channels.band.history(solution)

    def on_record(self, solution: Spectrum) -> Array:
        """Both at the samples of the record, shape (2, p, n)."""
        return self.channels.band.full_history(solution)
