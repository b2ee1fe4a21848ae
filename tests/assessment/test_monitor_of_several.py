"""The running errors of a test with several actuators: those of `rebuild`, however samples come."""

import numpy as np
import pytest
from coupled_structures import coupled_response, described, node, two_storeys

from reliab.assessment.inference.posterior import DRAWS
from reliab.assessment.monitor import Monitor
from reliab.assessment.rebuild import rebuild
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition

RATE = 256.0


def simulate_frame(build=two_storeys, seconds=24.0):
    partition, actuators = described(build)
    rng = np.random.default_rng(4)
    ground = np.convolve(rng.standard_normal(int(seconds * RATE)), np.ones(9) / 9.0, "same")
    run = coupled_response(partition, actuators, ground, 1.0 / RATE)
    noise = 1e-4 * np.abs(run.command).max(axis=1, keepdims=True) * rng.standard_normal(run.command.shape)
    return partition, run.command, run.measured + noise


@pytest.mark.slow
@pytest.mark.parametrize("lag", [0.0, 0.0031])
@pytest.mark.parametrize("build", [two_storeys, node])
def test_errors_are_those_of_the_whole_test_however_samples_come(build, lag):
    partition, command, measured_displacement = simulate_frame(build)
    carry = np.eye(partition.degrees) + 0.1
    monitor = Monitor(partition, 1.0 / RATE, to_interface=carry, feedback_lag=lag)
    cuts = [1, 2, 700, 3001]
    for rows in zip(
        np.split(command, cuts, axis=1), np.split(measured_displacement, cuts, axis=1), strict=True
    ):
        monitor.feed(*rows)
    full_test = rebuild(
        command,
        measured_displacement,
        1.0 / RATE,
        partition,
        to_interface=carry,
        feedback_lag=lag,
        sensor_offset=np.zeros(partition.degrees),
        draws=128,
    )
    for degree in full_test.displacements:
        now = monitor.displacements[degree.name]
        assert now.mte == pytest.approx(degree.mte.value, rel=2e-2)
        assert now.rms == pytest.approx(degree.rms.value, rel=1e-2)


@pytest.mark.slow
def test_answer_at_the_end_equals_the_error_rebuilt_afterwards():
    partition, command, measured_displacement = simulate_frame()
    monitor = Monitor(partition, 1.0 / RATE)
    for rows in zip(
        *(np.array_split(values, 9, axis=1) for values in (command, measured_displacement)), strict=True
    ):
        monitor.feed(*rows)
        if monitor.due:
            monitor.ask()
    at_end, afterwards = (
        monitor.ask(draws=DRAWS),
        rebuild(command, measured_displacement, 1.0 / RATE, partition),
    )
    for now, then in zip(at_end.displacements, afterwards.displacements, strict=True):
        assert (now.name, now.rms, now.mte) == (then.name, then.rms, then.mte)
        assert monitor.displacements[now.name].rms == pytest.approx(then.rms.value, rel=0.05)
    governing = afterwards.governing(Metric.RMS)
    assert monitor.governing == governing.name
    assert monitor.result.estimate(Metric.RMS) == governing.rms


def test_alarm_of_the_error_follows_any_displacement():
    partition = Partition(
        mass=np.eye(2),
        damping=0.5 * np.eye(2),
        stiffness=40.0 * np.eye(2),
        interface=np.eye(2),
        specimen_stiffness=40.0 * np.eye(2),
    )
    time = np.arange(0.0, 40.0, 1.0 / RATE)
    command = np.sin(np.sqrt(40.0) * time) * np.array([[1.0], [0.3]])
    noise = 1e-6 * np.random.default_rng(0).standard_normal(command.shape)
    error = []
    for gains in ([[1.0], [1.0]], [[1.0], [0.5]]):
        monitor = Monitor(partition, 1.0 / RATE)
        monitor.feed(command, gains * command + noise)
        monitor.ask()
        error.append(monitor.exceeds(0.05))
    assert error == [False, True]
    assert monitor.governing == "2"


def test_channels_of_another_number_are_refused():
    partition, command, measured_displacement = simulate_frame(seconds=2.0)
    with pytest.raises(InputError, match="must be those of 2 actuators"):
        Monitor(partition, 1.0 / RATE).feed(command[0], measured_displacement[0])
