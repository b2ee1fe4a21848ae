"""Evidence of the equation of motion: what is left of it over time and frequency.

The response without actuator errors follows from the channels in two ways (`rebuilt`). Their difference,
turned into forces at the interface, is the residual ::

    r = H⁻¹ (x_c + h a) − Z (x_c − x_f)

Where the ground acceleration a was recorded, r is what noise of the sensors and of the integration leave.
Where it was not, r is the force by which the ground drove the structure, and what is known of that is that
earthquakes are broad-band: smooth over frequency. The test is then as likely as an autoregressive process
with that innovation; its determinant is the second term of `ImpliedGroundMotion`.
"""

import numpy as np

from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.structure_response import respond
from reliab.core.arrays import Spectrum
from reliab.structures.partition import Partition


def residual(channels: ChannelSpectra, partition: Partition, experiment: Experiment) -> Spectrum:
    """Residual of the equation of motion [N], shape (p, K)."""
    response = respond(experiment.structure(partition), channels.band.s)
    command = channels.at_interface
    ground = experiment.ground(channels)
    driven = command if ground is None else command + response.ground.T * ground
    difference = command - experiment.late(experiment.reading(channels), channels)
    if experiment.integration:
        turned = (channels.band.s * channels.band.record_step) ** 2
        difference = difference - experiment.integration * turned * command
    acting = _times(response.impedance, difference)
    if experiment.slip is not None:
        acting = acting + _times(response.impedance, experiment.slip)
    if partition.degrees == 1:
        return np.asarray(driven / response.compliance[:, 0].T - acting)
    moved = np.linalg.solve(response.compliance, driven.T[..., np.newaxis])[..., 0]
    return np.asarray(moved.T - acting)


def _times(impedance: Spectrum, displacement: Spectrum) -> Spectrum:
    if impedance.shape[-1] == 1:
        return np.asarray(impedance[:, 0].T * displacement)
    return np.asarray((impedance @ displacement.T[..., np.newaxis])[..., 0].T)
