"""The monitor in C of several actuators gives the errors, by degree of freedom, that `assess` computes."""

import numpy as np
import pytest
from compiled_monitor import ERROR, FAULT, UNSTABLE, build, build_monitor, compare, follow, needs_compiler
from coupled_structures import coupled_response
from drawn_tests import draw_several_actuators, errors_of_assess, loop_with_delay, random_partition, shaken

from reliab.app.api.monitor import export_monitor
from reliab.assessment.rebuild import rebuild
from reliab.core.shipped import shipped
from reliab.in_loop.sources import LoopMonitor
from reliab.simulation.frames.frame_file import read_structure
from reliab.structures.critical_delay import stability_limit

pytestmark = needs_compiler
FRAME = shipped("datasets", "frames/two_actuators.toml")


def channels_of(frame, response):
    """Commands and measured displacements at the actuators."""
    return (frame.kinematics @ values for values in (response.command, response.measured))


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("seed", "rate"), [(0, 256), (1, 1024)])
def test_errors_by_degree_are_those_of_assess(tmp_path, seed, rate):
    compare(tmp_path, draw_several_actuators(seed, rate))


@pytest.mark.slow
def test_a_simulated_test_of_the_shipped_frame_is_followed(tmp_path):
    """The error of each degree is the true one, and the governing one that of `assess`."""
    frame, rate = read_structure(FRAME), 1024
    response = coupled_response(frame.partition, frame.transfer_system, shaken(rate), 1.0 / rate)
    command, reading = channels_of(frame, response)
    export_monitor(("c", tmp_path), structure=FRAME, rate=rate)
    ours = follow(build(tmp_path), command, reading, np.zeros(4))
    true = response.measured - response.reference
    peaks = np.abs(response.reference).max(axis=1, keepdims=True)
    expected = errors_of_assess(frame.partition, frame.to_interface, command, reading, rate)
    assert (np.abs(ours.error - expected) < 1e-12 * peaks).all()
    assert (np.abs(ours.error - true).max(axis=1) < 0.02 * np.abs(true).max(axis=1)).all()
    assessment = rebuild(
        command, reading, 1.0 / rate, frame.partition, to_interface=frame.to_interface, draws=8
    )
    errors = [degree.rms.value for degree in assessment.displacements]
    assert ours.rms[:, -1] == pytest.approx(errors, rel=0.02)
    assert ours.governing[-1] == np.argmax(errors)
    assert not (ours.status.astype(int) & (UNSTABLE | FAULT)).any()


def test_error_alarm_considers_every_degree(tmp_path):
    """Actuators that follow one degree only, and by a half."""
    frame, rate = read_structure(FRAME), 256
    command = np.linalg.inv(frame.to_interface) @ (
        1e-3 * np.sin(4.0 * np.arange(30 * rate) / rate) * [[1.0], [0.3]]
    )
    rotation = frame.kinematics @ np.diag([1.0, 0.5]) @ frame.to_interface
    noise = 1e-8 * np.random.default_rng(0).normal(size=command.shape)
    export_monitor(("c", tmp_path), structure=FRAME, rate=rate)
    library = build(tmp_path)
    sound = follow(library, command, command + noise)
    late = follow(library, command, rotation @ command + noise)
    assert not sound.status.any()
    assert int(late.status[-1]) & ERROR
    assert late.governing[-1] == 1


@pytest.mark.slow
def test_only_diverging_coupled_loop_raises_an_alarm(tmp_path):
    """Ten frames with 0.5 and 1.5 times their critical delay."""
    caught = false = 0
    rate = 2048
    for seed in range(10):
        partition = random_partition(seed)
        limit = stability_limit(partition).delay
        monitor = LoopMonitor(structure=partition, time_step=1.0 / rate)
        library = build_monitor(monitor, tmp_path / f"{seed}")
        for share in (0.5, 1.5):
            command, reading = loop_with_delay(partition, share * limit, rate, shaken(rate, 8.0, seed))
            noise = (
                np.random.default_rng(seed).normal(size=command.shape)
                * 1e-5
                * np.abs(command[:, :rate]).max()
            )
            status = follow(library, command, reading + noise).status.astype(int)
            error = bool((status & UNSTABLE).any())
            caught += error and share > 1.0
            false += error and share < 1.0
    assert (caught, false) == (10, 0)
