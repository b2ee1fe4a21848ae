"""The natural frequency that a test shows of its own structure, against simulations by another code."""

import numpy as np
import pytest

from rebuilt_error.laboratory import DELAY, RATE, Lab, run, synthetic_ground
from reliab.assessment.rebuilt_error.own_frequency import OwnFrequency, learn_frequency
from reliab.assessment.rebuilt_error.rebuild import rebuild
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

STEP = 1.0 / RATE


def simulate_structure(seed, f=1.3, xi=0.04, duration=30.0):
    return run(Lab(f, xi, 0.8, DELAY, (0.998, 0.001, 0.0, 0.0)), synthetic_ground(seed, duration))


def learn_from_outcome(outcome, f, xi=0.04, deviation=0.02):
    structure = Partition.from_structure(Structure(frequency=f, damping_ratio=xi, experimental_fraction=0.8))
    return learn_from_histories(outcome.command, outcome.command - outcome.measured, structure, deviation)


def learn_from_histories(command, difference, structure, deviation):
    command, difference = command[np.newaxis], difference[np.newaxis]
    return learn_frequency(command, difference, difference, STEP, structure, deviation, standing=np.zeros(1))


def two_storey_outcome(factor):
    """Two storeys whose stiffness is off by a factor, the lower one tested."""
    stiffness = 250.0 * factor * np.array([[2.0, -1.0], [-1.0, 1.0]])
    return Partition(
        mass=np.eye(2),
        damping=0.002 * stiffness + 0.2 * np.eye(2),
        stiffness=stiffness,
        interface=np.array([1.0, 0.0]),
        specimen_stiffness=250.0 * factor,
    )


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("off", [-0.05, 0.0, 0.05])
def test_the_frequency_of_the_structure_is_found_and_not_the_stated_one(off):
    """In its own standard deviations the mean of six tests strays by 2.6/√6 in one of a hundred cases."""
    scaled_copy = []
    for seed in range(6):
        screen = learn_from_outcome(simulate_structure(seed), 1.3 * (1.0 + off), deviation=0.05)
        scaled_copy.append((screen.value - (1.0 / (1.0 + off) - 1.0)) / screen.deviation)
        assert screen.deviation < 0.03
    assert abs(np.mean(scaled_copy)) < 2.6 / np.sqrt(6.0)


def test_a_contradiction_needs_a_wrong_frequency():
    outcomes = [simulate_structure(seed, xi=0.02) for seed in range(6)]
    wrong = [learn_from_outcome(outcome, 1.3 * 1.08, xi=0.02).contradicts for outcome in outcomes]
    right = [learn_from_outcome(outcome, 1.3, xi=0.02).contradicts for outcome in outcomes]
    assert sum(wrong) >= 4
    assert sum(right) <= 1


def test_free_vibration_shows_the_frequency_best():
    ground = synthetic_ground(2, 30.0)
    ground[int(10.0 * RATE) :] = 0.0
    ringing = run(Lab(1.3, 0.04, 0.8, DELAY, (0.998, 0.001, 0.0, 0.0)), ground)
    assert (
        learn_from_outcome(ringing, 1.3 * 1.03).deviation
        < 0.3 * learn_from_outcome(simulate_structure(2), 1.3 * 1.03).deviation
    )
    assert learn_from_outcome(ringing, 1.3 * 1.03).value == pytest.approx(1.0 / 1.03 - 1.0, abs=0.004)


def test_quantiles_are_those_of_statement_and_likelihood():
    """A flat likelihood leaves Student's t of the stated deviation, a sharp one a normal distribution."""
    offsets = np.linspace(-0.1, 0.1, 31)
    points = np.repeat([-1.6448536, 0.0, 1.6448536], 16)
    flat = OwnFrequency(
        offsets=offsets, likelihood=np.zeros(31), errors=0.05 - offsets**2, stated_deviation=0.02
    )
    draws = flat.offsets_at_points(points).reshape(3, 16)
    assert draws[:, 2:] == pytest.approx(np.tile([[-0.0422], [0.0], [0.0422]], 14), abs=0.003)
    assert draws[:, :2] == pytest.approx(np.zeros((3, 2)), abs=1e-12)
    sharp = OwnFrequency(
        offsets=offsets,
        likelihood=-0.5 * ((offsets - 0.01) / 0.004) ** 2,
        errors=0.05 + offsets,
        stated_deviation=1.0,
    )
    draws = sharp.offsets_at_points(points).reshape(3, 16)
    assert draws[:, 2] == pytest.approx(0.01 + 0.004 * points[::16], abs=2e-4)
    assert draws[:, 0] == pytest.approx(np.full(3, 0.01 + 2.0 * 0.004), abs=6e-4)
    assert (sharp.value, sharp.deviation) == pytest.approx((0.01, 0.004), abs=2e-4)


def test_an_exact_frequency_and_a_short_test_are_not_examined():
    assert learn_from_outcome(simulate_structure(1), 1.3, deviation=0.0) is None
    assert learn_from_outcome(simulate_structure(1, duration=7.0), 1.3) is None


def test_the_interval_holds_the_error_of_a_structure_five_per_cent_softer():
    """Whose stated deviation of two per cent alone leaves it outside."""
    outcome = simulate_structure(5)
    stated_values = Structure(frequency=1.3 * 1.05, damping_ratio=0.04, experimental_fraction=0.8)
    rebuilt = rebuild(
        outcome.command, outcome.measured, STEP, stated_values, tolerances=Tolerances(frequency=0.02)
    )
    assert rebuilt.rms.low <= outcome.rms <= rebuilt.rms.high
    assert rebuilt.unknown.own_frequency.value < -0.02


def test_a_frame_shows_its_first_frequency():
    """The command of the lower storey, computed by modes of the true frame under a smooth ground motion."""
    true, stated_values = two_storey_outcome(1.0), two_storey_outcome(1.08)
    ground = synthetic_ground(7, 40.0)
    values, shapes = np.linalg.eigh(true.stiffness)
    frequency = 2.0 * np.pi * np.fft.rfftfreq(2 * ground.size, STEP)
    spectrum = np.fft.rfft(ground, 2 * ground.size)
    response = sum(
        shapes[0, k]
        * shapes[:, k].sum()
        * -spectrum
        / (value - frequency**2 + 1j * frequency * (0.002 * value + 0.2))
        for k, value in enumerate(values)
    )
    command = np.fft.irfft(response)[: ground.size]
    screen = learn_from_histories(command, np.zeros(command.size), stated_values, 0.03)
    assert screen.value == pytest.approx(1.08**-0.5 - 1.0, abs=2.0 * screen.deviation)
    assert screen.deviation < 0.02
