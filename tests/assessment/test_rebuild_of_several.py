"""The error of several interface displacements, rebuilt from tests that an exact simulation made."""

from dataclasses import replace

import numpy as np
import pytest
from coupled_structures import coupled_response, lag

from reliab.assessment.inference.uncertain_quantity import PriorKnowledge
from reliab.assessment.rebuild import rebuild
from reliab.core.shipped import shipped
from reliab.core.vocabulary import Metric
from reliab.simulation.frames.frame_file import read_structure
from reliab.simulation.transfer_systems.transfer_function import ActuatorMatrix
from reliab.structures.partition import Partition

STEP = 1.0 / 256.0


def ground(seed, duration=20.0):
    """Motion of a random phase in each band, smooth between samples."""
    generator = np.random.default_rng(seed)
    time = np.arange(0.0, duration, STEP)
    waves = sum(
        np.sin(2.0 * np.pi * f * time + phase)
        for f, phase in zip(np.linspace(0.5, 6.0, 23), generator.uniform(0.0, 6.28, 23), strict=True)
    )
    return waves * np.minimum(time / 3.0, 1.0) ** 3 * np.exp(-(((time - 8.0) / 6.0) ** 2))


@pytest.fixture(scope="module")
def frame():
    return read_structure(shipped("datasets", "frames/two_actuators.toml"))


@pytest.fixture(scope="module")
def run(frame):
    return coupled_response(frame.partition, frame.transfer_system, ground(1), STEP)


def true_errors(run):
    error = run.measured - run.reference
    peak = np.abs(run.reference).max(axis=1)
    mean = np.sum(error**2, axis=1) / (error.shape[1] - 1)
    return np.sqrt(mean) / peak, np.abs(error).max(axis=1) / peak


def rebuilt(frame, run, noise=0.0, seed=0, draws=32, **options):
    command, measured_displacement = frame.kinematics @ run.command, frame.kinematics @ run.measured
    generator = np.random.default_rng(seed)
    measured_displacement = measured_displacement + noise * measured_displacement.std(
        axis=1, keepdims=True
    ) * generator.normal(size=measured_displacement.shape)
    return rebuild(
        command,
        measured_displacement,
        STEP,
        frame.partition,
        to_interface=frame.to_interface,
        draws=draws,
        **options,
    )


def test_without_noise_it_is_the_true_error(frame, run):
    error = rebuilt(frame, run, draws=128)
    rms, mte = true_errors(run)
    np.testing.assert_allclose([degree.rms.value for degree in error.displacements], rms, rtol=1e-3)
    np.testing.assert_allclose([degree.mte.value for degree in error.displacements], mte, rtol=1e-3)


def test_parts_of_actuators_and_causes_add_up_to_the_error(frame, run):
    """The parts are those of the most probable world, the error is the mean over all."""
    error = rebuilt(frame, run, draws=64)
    together = np.sum(list(error.division.pieces.values()), axis=0)
    for place, degree in enumerate(error.displacements):
        parts = error.division.parts(place)
        assert sum(part.share for part in parts.by_name.values()) == pytest.approx(1.0, abs=1e-9)
        assert parts.rms == pytest.approx(degree.rms.value, rel=1e-3)
        inner, size = slice(20, -20), np.abs(degree.smooth_error).max()
        np.testing.assert_allclose(together[place, inner], degree.smooth_error[inner], atol=2e-3 * size)


def test_with_noise_it_stays_near_the_true_error(frame, run):
    """Over histories of the noise the ratio scatters by 1 %."""
    error = rebuilt(frame, run, noise=0.01)
    rms, _ = true_errors(run)
    np.testing.assert_allclose([degree.rms.value for degree in error.displacements], rms, rtol=0.03)


def test_an_interval_reaches_down_to_the_error_of_sensors_without_an_offset(frame, run):
    unknown = PriorKnowledge(tolerances={"sensor_offset": 0.5 * float(np.abs(run.measured[0]).max())})
    exact, result = (rebuilt(frame, run, noise=0.01, known=single) for single in (PriorKnowledge(), unknown))
    for least, degree in zip(exact.displacements, result.displacements, strict=True):
        assert degree.rms.low < 0.5 * (least.rms.value + least.rms.high)
        assert degree.rms.high > least.rms.high


def test_stated_offsets_are_taken_away_and_none_is_left_open(frame, run):
    offsets = np.array([0.3, -0.2]) * np.abs(run.measured[0]).max()
    shift = replace(run, measured=run.measured + np.linalg.solve(frame.kinematics, offsets)[:, np.newaxis])
    exact, stated_values = (
        rebuilt(frame, run, draws=4),
        rebuilt(frame, shift, draws=4, sensor_offset=offsets),
    )
    assert [start.offset_deviation for start in stated_values.readings.starts] == [0.0, 0.0]
    result, expected = (
        [degree.rms.value for degree in single.displacements] for single in (stated_values, exact)
    )
    assert result == pytest.approx(expected, rel=1e-4)


def test_all_displacements_have_to_stay_below_a_threshold_together(frame, run):
    """Each does so in half of the draws, both in none."""
    result, errors = rebuilt(frame, run, draws=4), np.array([0.01, 0.01, 0.09, 0.09])
    displacements = tuple(
        replace(degree, draws=replace(degree.draws, rms=row, weights=np.ones(4)))
        for degree, row in zip(result.displacements, (errors, errors[::-1]), strict=True)
    )
    together = replace(result, displacements=displacements)
    assert [degree.probability(0.05) for degree in displacements] == [0.5, 0.5]
    assert together.probability(0.05) == pytest.approx(0.5 / 5.0)


@pytest.mark.parametrize("deviation", [0.0, 0.02])
def test_test_beginning_in_motion_is_judged_with_an_uncertain_structure(frame, run, deviation):
    """Each draw begins with a motion of its own structure."""
    later = replace(
        run, **{name: getattr(run, name)[:, 1000:] for name in ("command", "measured", "reference")}
    )
    result = rebuilt(frame, later, draws=64, known=PriorKnowledge(tolerances={"frequency": deviation}))
    for degree, true in zip(result.displacements, true_errors(later)[0], strict=True):
        assert degree.rms.low < true < degree.rms.high


def test_mode_ringing_below_the_noise_is_part_of_the_error(frame):
    """Theta's mode of 24 Hz hardly decays in the loop; their noise hides its motion."""
    lags = ((lag(1.0, 850.0), lag(0.03, 850.0)), (None, lag(1.0, 850.0)))
    time = STEP * np.arange(ground(1).size)
    kick = 10.0 * np.sin(150.0 * time) * np.exp(-(((time - 4.0) / 0.2) ** 2))
    actuators = ActuatorMatrix(kinematics=frame.kinematics, transfer=lags)
    run = coupled_response(frame.partition, actuators, ground(1) + kick, STEP)
    theta = rebuilt(frame, run, noise=0.0316, seed=1).displacements[1].rms
    true = true_errors(run)[0][1]
    assert theta.value == pytest.approx(true, rel=0.1)
    assert theta.low <= true <= theta.high


def test_common_noise_of_both_sensors_cancels_in_their_difference(frame, run):
    """Theta is the difference of two parallel actuators: it stays as it is where both have one noise."""
    command, measured_displacement = frame.kinematics @ run.command, frame.kinematics @ run.measured
    generator = np.random.default_rng(5)
    own_value = 2e-2 * measured_displacement.std() * generator.normal(size=measured_displacement.shape)
    remainder = []
    for noise in (own_value, own_value[:1]):
        error = rebuild(
            command,
            measured_displacement + noise,
            STEP,
            frame.partition,
            to_interface=frame.to_interface,
            draws=8,
        )
        remainder.append(error.displacements[1].noise)
    assert remainder[1] < 0.3 * remainder[0]


def test_a_wrong_frequency_is_covered_by_its_tolerance(frame, run):
    wrong = replace(frame, partition=frame.partition.scale(frequency=1.03))
    exact, loose = (
        rebuilt(wrong, run, noise=0.01, known=tolerances).displacements[0].rms
        for tolerances in (PriorKnowledge(), PriorKnowledge(tolerances={"frequency": 0.02}))
    )
    true = true_errors(run)[0][0]
    assert not exact.low <= true <= exact.high
    assert loose.low <= true <= loose.high


def test_degree_at_rest_is_not_judged(run):
    command, measured_displacement = run.command.copy(), run.measured.copy()
    command[1], measured_displacement[1] = 0.0, 1e-9 * np.random.default_rng(0).normal(size=command.shape[1])
    scarcely = np.diag([1.0, 1.0])
    partition = Partition(
        mass=np.diag([4000.0, 40.0]),
        damping=np.diag([4000.0, 100.0]),
        stiffness=np.diag([2e6, 9e5]),
        interface=scarcely,
        specimen_stiffness=np.diag([1.4e6, 4e5]),
        names=("x", "theta"),
    )
    error = rebuild(command, measured_displacement, STEP, partition, draws=8)
    assert [degree.judged for degree in error.displacements] == [True, False]
    assert error.governing(Metric.RMS).name == "x"


@pytest.mark.slow
def test_intervals_hold_the_true_error_in_most_tests(frame):
    """60 tests under other ground motions, noise at 40 dB; both displacements of each."""
    ratios, coverage = [], []
    for seed in range(100, 160):
        run = coupled_response(frame.partition, frame.transfer_system, ground(seed), STEP)
        error = rebuilt(frame, run, noise=0.01, seed=seed, draws=128)
        for degree, true in zip(error.displacements, true_errors(run)[0], strict=True):
            ratios.append(degree.rms.value / true)
            coverage.append(degree.rms.low <= true <= degree.rms.high)
    assert np.mean((np.array(ratios) > 0.98) & (np.array(ratios) < 1.02)) >= 0.87
    assert np.mean(coverage) >= 0.85
