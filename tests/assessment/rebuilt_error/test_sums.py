"""Sums over the error of a running test, and properties of the first mode, by their definitions."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.initial import _amplitude, _constant
from reliab.assessment.rebuilt_error.loop_energy import select_modes
from reliab.assessment.rebuilt_error.running_error import RunningError
from reliab.structures.partition import Partition, whole_structure
from reliab.structures.structure import Structure

STEP = 1.0 / 256.0
OFFSET, STANDING = 2e-4, -3e-4


@pytest.fixture
def histories():
    time = np.arange(1500) * STEP
    command = 1e-2 * np.cos(2.0 * np.pi * 1.1 * time) * np.exp(-((time - 2.0) ** 2))
    return command, 0.99 * np.interp(time - 0.004, time, command) + 5e-4


def running(offset=OFFSET):
    structure = whole_structure(Structure(frequency=1.0, damping_ratio=0.05))
    return RunningError(structure, STEP, 0.0, np.array([offset]))


def sums_by_definition(test):
    (error,) = test.error
    ideal = test.measured[0] - test.offsets[0] - error
    level, doubled = 0.0, 0
    for number, size in enumerate(np.maximum.accumulate(np.abs(ideal))):
        if size > 2.0 * level:
            level, doubled = size, number
    extremes = np.abs(error).max(), np.abs(ideal).max()
    return [np.sum(error**2), 0.5 * error[0] ** 2, *extremes, error[-1], level, doubled]


@pytest.mark.parametrize("cuts", [(), (1,), (700, 701), (5, 1499)])
def test_sums_are_those_of_the_error_however_the_samples_arrive(histories, cuts):
    test = running()
    for command, measured_displacement in zip(
        *(np.split(history, cuts) for history in histories), strict=True
    ):
        test.feed(command[np.newaxis], measured_displacement[np.newaxis])
        assert test.sums[0].values == pytest.approx(sums_by_definition(test), rel=1e-9)


def test_a_later_offset_changes_the_sums_to_those_of_the_changed_error(histories):
    """And what is fed after it goes on from there."""
    test = running(offset=0.0)
    test.feed(*(history[np.newaxis, :900] for history in histories))
    first = test.error.copy()
    test.begin_anew(np.array([OFFSET]), np.array([STANDING]))
    assert np.abs(test.error - first).max() > 1e-5
    assert test.sums[0].values == pytest.approx(sums_by_definition(test), rel=1e-9)
    test.feed(*(history[np.newaxis, 900:] for history in histories))
    assert test.sums[0].values == pytest.approx(sums_by_definition(test), rel=1e-9)


@pytest.mark.parametrize("count", [1, 700, 999])
def test_forgotten_samples_stay_in_the_sums(histories, count):
    full_test, test = running(), running()
    for item in (full_test, test):
        item.feed(*(history[np.newaxis, :1000] for history in histories))
    test.forget(count)
    assert (test.kept_samples, test.size) == (1000 - count, 1000)
    assert np.array_equal(test.command[0], histories[0][count:1000])
    for item in (full_test, test):
        item.feed(*(history[np.newaxis, 1000:] for history in histories))
    assert np.array_equal(test.sums[0].values, full_test.sums[0].values)
    assert np.array_equal(test.error, full_test.error[:, count:])
    assert (test.sums[0].mean_square, test.sums[0].calm) == (
        full_test.sums[0].mean_square,
        full_test.sums[0].calm,
    )


def test_mean_square_joins_squares_by_straight_lines():
    assert mean_square(np.array([0.0, 2.0, 0.0])) == pytest.approx(2.0)
    assert mean_square(np.array([2.0, 0.0, 4.0])) == pytest.approx((4.0 / 2.0 + 16.0 / 2.0) / 2.0)


def heavy(mass, frequency, ratio, share):
    w0 = 2.0 * np.pi * frequency
    return Partition(
        mass=np.array([[mass]]),
        damping=np.array([[2.0 * ratio * w0 * mass]]),
        stiffness=np.array([[w0**2 * mass]]),
        interface=np.ones(1),
        specimen_stiffness=share * w0**2 * mass,
    )


@pytest.mark.parametrize("mass", [1.0, 3.0, 2500.0])
def test_damping_of_the_first_mode_does_not_depend_on_the_mass(mass):
    """αω₀², and a window that forgets all but 1/e in three periods."""
    (mode,) = select_modes(heavy(mass, 1.5, 0.04, 0.6), STEP)
    assert mode.ratio == pytest.approx(0.04)
    assert mode.stiffness == pytest.approx(0.6 * (2.0 * np.pi * 1.5) ** 2)
    assert mode.samples == pytest.approx(256.0 / 1.5)
    assert mode.forgetting ** (3.0 * mode.samples) == pytest.approx(np.exp(-1.0))


def test_remainder_of_gain_and_delay_is_the_constant(histories):
    command, _ = histories
    velocity = np.gradient(command, STEP)
    for constant in (3e-4, -2e-5):
        measured_displacement = 0.97 * command - 0.004 * velocity + constant
        assert _constant(command, measured_displacement, STEP) == pytest.approx(constant, rel=1e-6)


def test_amplitude_at_the_beginning_counts_displacement_and_velocity():
    place = np.arange(400)
    command = 3e-3 + 2e-5 * place + 1e-8 * place**2
    amplitude = np.hypot(3e-3, 2e-5 / STEP / (2.0 * np.pi * 1.5))
    assert _amplitude(command, STEP, 1.5) == pytest.approx(amplitude, rel=1e-6)


def test_a_scaled_structure_has_the_scaled_frequency_damping_ratio_and_share():
    structure = replace(heavy(3.0, 1.5, 0.04, 0.6), specimen_damping=2.0, specimen_mass=0.5)
    variant = structure.scale(frequency=1.2, damping_ratio=1.5, share=0.7)
    expected = heavy(3.0, 1.2 * 1.5, 1.5 * 0.04, 0.7 * 0.6)
    for field in ("mass", "damping", "stiffness", "specimen_stiffness"):
        assert getattr(variant, field) == pytest.approx(getattr(expected, field)), field
    assert variant.specimen_damping == pytest.approx(2.0 * 1.2 * 0.7)
    assert variant.specimen_mass == pytest.approx(0.5 * 0.7)
