"""The monitor in C of several actuators gives the errors, by degree of freedom, that `assess` computes."""

import numpy as np
import pytest
from compiled_monitor import ERROR, FAULT, UNSTABLE, built, followed, needs_compiler

from reliab.api import export_monitor
from reliab.assessment.coupled_error import CoupledRecursion, rebuild_coupled
from reliab.assessment.rebuilt_error import delayed
from reliab.in_loop import LoopMonitor, monitor_sources
from reliab.shipped import shipped
from reliab.simulation.frames import coupled_response, read_structure
from reliab.structures import CoupledPartition, coupled_limit

pytestmark = needs_compiler
FRAME = shipped("datasets", "frames/two_actuators.toml")


def shaken(rate, seconds=12.0, seed=0):
    """A ground acceleration that begins and ends at rest [m/s²]."""
    time = np.arange(int(seconds * rate)) / rate
    values = np.random.default_rng(seed).normal(size=int(seconds * 32))
    return np.interp(time, np.arange(values.size) / 32, values) * np.sin(np.pi * time / seconds) ** 2


def channels_of(frame, response):
    """Commands and measured displacements at the actuators."""
    return (frame.kinematics @ values for values in (response.command, response.measured))


def by_assess(partition, carry, command, measured, rate, lag=0.0, standing=None):
    """Errors by degree of freedom as `assess` computes them, without taking noise away."""
    recursion = CoupledRecursion.of_partition(partition.with_masses, 1.0 / rate)
    felt = np.stack([delayed(row, lag, 1.0 / rate) for row in measured])
    state = None if standing is None else recursion.static @ carry @ standing
    return recursion.respond(carry @ (command - felt), state) - carry @ (command - measured)


def random_partition(seed):
    """A frame of some storeys of which two or three displacements are driven, coupled by the specimen."""
    rng = np.random.default_rng((seed, 7))
    floors, degrees = int(rng.integers(3, 6)), int(rng.integers(2, 4))
    stiffness = 2.0 * np.eye(floors) - np.eye(floors, k=1) - np.eye(floors, k=-1)
    stiffness *= (2.0 * np.pi * rng.uniform(0.8, 3.0)) ** 2
    own, across, rest = (
        stiffness[:degrees, :degrees],
        stiffness[:degrees, degrees:],
        stiffness[degrees:, degrees:],
    )
    share = (own - across @ np.linalg.solve(rest, across.T)) * rng.uniform(0.2, 0.9)
    return CoupledPartition(
        mass=np.diag(rng.uniform(0.5, 2.0, floors)),
        damping=2e-3 * stiffness,
        stiffness=stiffness,
        interface=np.eye(floors)[:, :degrees],
        specimen_stiffness=share,
        specimen_damping=1e-3 * share,
        specimen_mass=0.05 * np.eye(degrees),
    )


def compare(folder, seed, rate):
    """A test of a random frame with coupled kinematics, offsets, standing differences and a late force."""
    rng = np.random.default_rng((seed, 8))
    partition = random_partition(seed)
    carry = np.eye(partition.degrees) + 0.3 * rng.normal(size=(partition.degrees, partition.degrees))
    lag = float(rng.choice([0.0, 0.4, 2.7])) / rate
    command = np.cumsum(rng.normal(size=(partition.degrees, 6 * rate)), axis=1) * 1e-3 / np.sqrt(rate)
    measured = 0.98 * command + 1e-5 * rng.normal(size=command.shape)
    begin = 1e-4 * rng.normal(size=(2, partition.degrees))
    monitor = LoopMonitor(structure=partition, to_interface=carry, time_step=1.0 / rate, feedback_lag=lag)
    for name, text in monitor_sources(monitor).items():
        (folder / name).write_text(text, encoding="utf-8")
    ours = followed(built(folder), command, measured, begin.ravel())
    expected = by_assess(partition, carry, command, measured - begin[0][:, np.newaxis], rate, lag, begin[1])
    peaks = np.abs(carry @ command).max(axis=1, keepdims=True)
    assert (np.abs(ours.error - expected) < 1e-12 * peaks).all()
    reference = carry @ (measured - begin[0][:, np.newaxis]) - expected
    sizes = np.abs(expected).max(axis=1) / np.abs(reference).max(axis=1)
    assert ours.mte[:, -1] == pytest.approx(sizes, rel=1e-9)


@pytest.mark.parametrize(("seed", "rate"), [(0, 256), (1, 1024)])
def test_errors_by_degree_are_those_of_assess(tmp_path, seed, rate):
    compare(tmp_path, seed, rate)


@pytest.mark.slow
@pytest.mark.parametrize("rate", [256, 1024, 4096])
def test_errors_of_many_frames_are_those_of_assess(tmp_path, rate):
    for seed in range(12):
        (tmp_path / f"{seed}").mkdir()
        compare(tmp_path / f"{seed}", seed, rate)


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
    errors = [degree.rms.value for degree in assessed.degrees]
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


def delayed_loop(partition, delay, rate, seconds, seed):
    """Commands and measured displacements of a loop whose actuators are late by whole samples."""
    whole = partition.with_masses
    gamma, late = whole.interface, round(delay * rate)
    parts = [whole.mass, whole.damping, whole.stiffness]
    specimen = [whole.specimen_mass, whole.specimen_damping, whole.specimen_stiffness]
    mass, damping, stiffness = (whole.numerical(*pair) for pair in zip(parts, specimen, strict=True))
    ground = shaken(rate, seconds, seed)
    x, v = np.zeros(whole.size), np.zeros(whole.size)
    moved = np.zeros((ground.size + late + 1, whole.degrees))
    inverse = np.linalg.inv(mass)
    for k in range(ground.size):
        y = moved[k]
        rate_of_y = (moved[k] - moved[max(k - 1, 0)]) * rate
        force = whole.specimen_stiffness @ y + whole.specimen_damping @ rate_of_y
        a = inverse @ (
            -whole.mass @ whole.influence * ground[k] - damping @ v - stiffness @ x - gamma @ force
        )
        v = v + a / rate
        x = x + v / rate
        moved[k + late + 1] = gamma.T @ x
    command = moved[late + 1 :].T
    return np.ascontiguousarray(command), np.ascontiguousarray(moved[: ground.size].T)


@pytest.mark.slow
def test_a_coupled_loop_that_diverges_is_caught_and_a_stable_one_is_not(tmp_path):
    """Ten frames with 0.5 and 1.5 times their critical delay."""
    caught = false = 0
    rate = 2048
    for seed in range(10):
        partition = random_partition(seed)
        limit = coupled_limit(partition).delay
        monitor = LoopMonitor(structure=partition, time_step=1.0 / rate)
        (tmp_path / f"{seed}").mkdir()
        for name, text in monitor_sources(monitor).items():
            (tmp_path / f"{seed}" / name).write_text(text, encoding="utf-8")
        library = built(tmp_path / f"{seed}")
        for share in (0.5, 1.5):
            command, measured = delayed_loop(partition, share * limit, rate, 8.0, seed)
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
