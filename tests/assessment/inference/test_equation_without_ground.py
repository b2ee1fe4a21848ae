"""Equations of several interface displacements without the ground acceleration that they share."""

import numpy as np
import pytest
from coupled_structures import coupled_response, described, node, two_storeys

from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.evidence import EquationWithoutGround
from reliab.assessment.inference.experiment import Experiment

STEP = 1.0 / 512.0


def shaking(seed):
    """Band-limited noise of 16 s that grows from rest and ends 4 s before the record does [m/s²]."""
    noise = np.random.default_rng(seed).standard_normal(8192)
    smooth, time = np.convolve(noise, np.hanning(40), mode="same"), np.arange(noise.size) * STEP
    return smooth * np.clip(np.minimum(time, 12.0 - time) / 4.0, 0.0, 1.0) / 5.0


def channels_of(structure, command, measured_displacement):
    partition, actuators = described(structure)
    kinematics = actuators.kinematics
    read = kinematics @ measured_displacement
    noise = np.random.default_rng(7).standard_normal(read.shape)
    return ChannelSpectra.from_channels(
        kinematics @ command,
        read + 0.01 * read.std(axis=1, keepdims=True) * noise,
        STEP,
        partition,
        interface_matrix=np.linalg.inv(kinematics),
    )


def misfit(structure, channels, **changes):
    """What remains of the equations over the deviation of its noise [-], and whether they are used."""
    partition, _ = described(structure)
    evidence = EquationWithoutGround(channels=channels, partition=partition)
    world = Experiment.as_stated(partition.degrees)
    for name, value in changes.items():
        setattr(world, name, value)
    return float(np.sqrt(np.mean(evidence.cells(world) ** 2))), evidence.holds(world)


@pytest.mark.parametrize("structure", [two_storeys, node])
def test_only_the_true_structure_leaves_no_more_than_noise_of_any_ground_motion(structure):
    """Simulated by exact steps, with noise of 1 % in each sensor; the ground motion is told to nobody."""
    partition, actuators = described(structure)
    for seed in (1, 2):
        run = coupled_response(partition, actuators, shaking(seed), STEP)
        channels = channels_of(structure, run.command, run.measured)
        as_stated, holds = misfit(structure, channels)
        assert holds
        assert as_stated == pytest.approx(1.0, rel=0.1)
        for off in ({"frequency": 1.02}, {"skew": np.full(partition.degrees, 4e-3)}):
            assert misfit(structure, channels, **off)[0] > 5.0


def test_motion_by_more_than_one_ground_acceleration_shows_nothing():
    """The sum of two tests in two directions, of which the second is three times as strong."""
    partition, actuators = described(node)
    other = partition.replace_values(influence=np.array([-0.3, 1.0, 0.0, 0.2]))
    runs = [
        coupled_response(partition, actuators, shaking(0), STEP),
        coupled_response(other, actuators, 3.0 * shaking(1), STEP),
    ]
    command, measured_displacement = (
        sum(getattr(run, name) for run in runs) for name in ("command", "measured")
    )
    assert not misfit(node, channels_of(node, command, measured_displacement))[1]
