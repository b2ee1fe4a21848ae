"""The monitor in C of several actuators gives the errors, by degree of freedom, that `assess` computes."""

import numpy as np
import pytest
from compiled_monitor import ERROR, FAULT, UNSTABLE, built, built_of, compare, followed, needs_compiler
from coupled_structures import coupled_response
from drawn_tests import by_assess, delayed_loop, of_several_actuators, random_partition, shaken

from reliab.app.api.in_loop import export_monitor
from reliab.assessment.coupled_error.rebuild import rebuild_coupled
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
    compare(tmp_path, of_several_actuators(seed, rate))


@pytest.mark.slow
def test_a_simulated_test_of_the_shipped_frame_is_followed(tmp_path):
    """The error of each degree is the true one, and the governing one that of `assess`."""
    frame, rate = read_structure(FRAME), 1024
    response = coupled_response(frame.partition, frame.transfer_system, shaken(rate), 1.0 / rate)
    command, measured = channels_of(frame, response)
    export_monitor(("c", tmp_path), structure=FRAME, rate=rate)
    ours = followed(built(tmp_path), command, measured, np.zeros(4))
    true = response.measured - response.reference
    peaks = np.abs(response.reference).max(axis=1, keepdims=True)
    expected = by_assess(frame.partition, frame.to_interface, command, measured, rate)
    assert (np.abs(ours.error - expected) < 1e-12 * peaks).all()
    assert (np.abs(ours.error - true).max(axis=1) < 0.02 * np.abs(true).max(axis=1)).all()
    assessed = rebuild_coupled(
        command, measured, 1.0 / rate, frame.partition, to_interface=frame.to_interface, draws=8
    )
    errors = [degree.rms.value for degree in assessed.displacements]
    assert ours.rms[:, -1] == pytest.approx(errors, rel=0.02)
    assert ours.governing[-1] == np.argmax(errors)
    assert not (ours.status.astype(int) & (UNSTABLE | FAULT)).any()


def test_the_alarm_of_the_error_is_that_of_any_degree(tmp_path):
    """Actuators that follow one degree only, and by a half."""
    frame, rate = read_structure(FRAME), 256
    command = np.linalg.inv(frame.to_interface) @ (
        1e-3 * np.sin(4.0 * np.arange(30 * rate) / rate) * [[1.0], [0.3]]
    )
    turned = frame.kinematics @ np.diag([1.0, 0.5]) @ frame.to_interface
    noise = 1e-8 * np.random.default_rng(0).normal(size=command.shape)
    export_monitor(("c", tmp_path), structure=FRAME, rate=rate)
    library = built(tmp_path)
    sound = followed(library, command, command + noise)
    late = followed(library, command, turned @ command + noise)
    assert not sound.status.any()
    assert int(late.status[-1]) & ERROR
    assert late.governing[-1] == 1


@pytest.mark.slow
def test_a_coupled_loop_that_diverges_is_caught_and_a_stable_one_is_not(tmp_path):
    """Ten frames with 0.5 and 1.5 times their critical delay."""
    caught = false = 0
    rate = 2048
    for seed in range(10):
        partition = random_partition(seed)
        limit = stability_limit(partition).delay
        monitor = LoopMonitor(structure=partition, time_step=1.0 / rate)
        library = built_of(monitor, tmp_path / f"{seed}")
        for share in (0.5, 1.5):
            command, measured = delayed_loop(partition, share * limit, rate, shaken(rate, 8.0, seed))
            noise = (
                np.random.default_rng(seed).normal(size=command.shape)
                * 1e-5
                * np.abs(command[:, :rate]).max()
            )
            status = followed(library, command, measured + noise).status.astype(int)
            raised = bool((status & UNSTABLE).any())
            caught += raised and share > 1.0
            false += raised and share < 1.0
    assert (caught, false) == (10, 0)
