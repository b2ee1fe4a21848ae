"""How a recording begins: whether an offset was in the loop, and how well it is known."""

import numpy as np
import pytest

from reliab.assessment.rebuilt_error.initial import (
    _loop_felt,
    _stands,
    check_histories,
    examine_start,
)
from reliab.core.errors import InputError
from reliab.structures.partition import Partition

STEP = 1.0 / 256.0
FREQUENCY = 1.0
SHARE = 0.6
WHITE, SLOW = 1e-5, 2e-6


def vibrating(remainder, size=4096, seed=1):
    """A command that stands for `remainder` samples and then moves by 1 cm about zero."""
    time = STEP * np.arange(size - remainder)
    rng = np.random.default_rng(seed)
    waves = [
        np.sin(2.0 * np.pi * f * time + p)
        for f, p in zip(rng.uniform(0.7, 2.0, 6), rng.uniform(0, 6, 6), strict=True)
    ]
    displacement = np.minimum(time, 1.0) ** 2 * np.mean(waves, axis=0)
    return np.concatenate([np.zeros(remainder), 0.01 * displacement / np.abs(displacement).max()])


def examine(command, measured_displacement, white=WHITE, slow=SLOW, share=SHARE):
    return examine_start(command, measured_displacement, STEP, FREQUENCY, white, slow, share)


@pytest.mark.parametrize("remainder", [200, 700])
def test_an_offset_of_the_sensor_is_the_mean_of_the_rest(remainder):
    command = vibrating(remainder)
    noise = WHITE * np.random.default_rng(2).standard_normal(command.size)
    start = examine(command, command + 5e-4 + noise)
    assert start.at_rest
    assert start.standing == start.amplitude == 0.0
    still = int(np.argmax(np.abs(command) > 2e-3 * np.abs(command).max()))
    assert start.offset == pytest.approx(5e-4 + noise[:still].mean(), rel=1e-9)
    assert start.offset_deviation == pytest.approx(np.hypot(WHITE / np.sqrt(still), SLOW))


def test_at_most_a_quarter_of_the_record_counts_as_rest():
    command = vibrating(2000)
    start = examine(command, command + 5e-4)
    assert start.offset_deviation == pytest.approx(np.hypot(WHITE / np.sqrt(1024), SLOW))


def test_an_offset_within_the_noise_is_left_and_remains_uncertain():
    command = vibrating(400)
    still = int(np.argmax(np.abs(command) > 2e-3 * np.abs(command).max()))
    deviation = np.hypot(WHITE / np.sqrt(still), SLOW)
    motion = np.abs(command[:still]).max()
    for factor, duration in ((0.99, False), (1.01, True)):
        offset = factor * (4.0 * deviation + motion)
        start = examine(command, command + offset)
        assert start.offset == pytest.approx(offset if duration else 0.0)


def test_an_offset_in_the_loop_is_an_error_and_nothing_is_taken_away():
    """The command then moves about −share times the offset, which the rest is too short to show."""
    size, offset = 8192, 2e-4
    taper = np.minimum(STEP * np.arange(size), 1.0)
    command = vibrating(10, size) - SHARE * offset * (1.0 - np.cos(np.pi * taper)) / 2.0
    assert _loop_felt(command, command + offset, offset, SHARE) is True
    assert examine(command, command + offset).offset == 0.0
    unmoved = vibrating(10, size)
    assert _loop_felt(unmoved, unmoved + offset, offset, SHARE) is False
    start = examine(unmoved, unmoved + offset)
    assert start.offset == pytest.approx(offset, rel=1e-6)
    assert start.offset_deviation < 0.1 * offset


def test_undecidable_offset_stays_open():
    """Slow ground motion as large as the offset's answer hides it: the whole offset is uncertain."""
    size, offset = 4096, 2e-4
    drift = (
        4e-3
        * np.sin(2.0 * np.pi * np.arange(size) / size * 2.5)
        * np.minimum(np.arange(size) / 500, 1.0) ** 2
    )
    command = vibrating(10, size) + drift
    assert _loop_felt(command, command + offset, offset, SHARE) is None
    start = examine(command, command + offset)
    assert start.offset == pytest.approx(offset, rel=1e-3)
    assert start.offset_deviation == pytest.approx(np.hypot(offset, SLOW), rel=0.01)


def test_a_command_that_stands_at_the_shifted_place_was_shifted_before_the_record():
    command = vibrating(600)
    offset = 5e-4
    start = examine(command - SHARE * offset, command - SHARE * offset + offset)
    assert start.at_rest
    assert start.standing == pytest.approx(offset)
    assert start.offset == 0.0


@pytest.mark.parametrize(
    ("place", "stands"), [(0.0, False), (-0.89, False), (-0.91, True), (-1.09, True), (-1.11, False)]
)
def test_a_command_stands_within_a_tenth_of_the_shift(place, stands):
    offset = 1e-3
    command = np.full(50, place * SHARE * offset)
    assert _stands(command, offset, 1e-5, SHARE) is stands
    assert not _stands(command, offset, 2.6e-4, SHARE)


@pytest.mark.parametrize(("fraction", "rest_error"), [(0.8e-3, True), (1.3e-3, False)])
def test_rest_is_a_first_motion_below_a_thousandth(fraction, rest_error):
    time = STEP * np.arange(4096)
    growing = 1.0 - np.exp(-((time / 2.0) ** 4))
    command = 0.01 * (np.sin(2.0 * np.pi * time) * growing + fraction * np.cos(2.0 * np.pi * time))
    assert examine(command, command).at_rest is rest_error


def test_a_test_in_motion_keeps_its_constant_as_uncertainty_unless_the_loop_felt_it():
    time = STEP * np.arange(8192)
    offset = 1e-3
    command = 0.01 * np.cos(2.0 * np.pi * time)
    reference = np.hypot(WHITE / np.sqrt(8192), SLOW)
    start = examine(command, command + offset)
    assert (start.at_rest, start.offset) == (False, 0.0)
    assert start.amplitude == pytest.approx(0.01, rel=1e-3)
    assert start.offset_deviation == pytest.approx(np.hypot(offset, reference), rel=1e-3)
    felt_displacement = examine(command - SHARE * offset, command + (1.0 - SHARE) * offset)
    assert felt_displacement.offset_deviation == pytest.approx(reference)


def test_a_period_of_ten_samples_is_enough():
    full_test = Partition(
        mass=np.eye(1),
        damping=np.zeros((1, 1)),
        stiffness=np.array([[(2.0 * np.pi) ** 2]]),
        interface=np.ones(1),
        specimen_stiffness=1.0,
    )
    assert full_test.natural_frequencies[0] == 1.0
    command = np.sin(np.arange(64.0))
    assert check_histories(command, command, 0.1, full_test)[0].size == 64
    with pytest.raises(InputError, match="at least 10 samples"):
        check_histories(command, command, 0.1001, full_test)
    with pytest.raises(InputError, match="at least 64 samples"):
        check_histories(command[1:], command[1:], 0.1, full_test)


@pytest.mark.parametrize(("frequency", "step"), [(1.0, STEP), (0.25, 4.0 * STEP), (8.0, STEP / 8.0)])
@pytest.mark.parametrize(("factor", "concludes"), [(0.98, False), (1.02, True)])
def test_a_rest_concludes_once_a_structure_of_any_frequency_would_have_moved(
    frequency, step, factor, concludes
):
    """Its answer is four times what counts as rest; slow motion hides what the rest of the record shows."""
    remainder, size, share = 64, 4096, 0.6
    swing = 4.0 * np.sin(2.0 * np.pi * np.arange(size - remainder) / (size - remainder))
    command = np.concatenate([np.zeros(remainder), vibrating(0, size - remainder) + 0.01 * swing])
    peak = np.abs(command).max()
    still = int(np.argmax(np.abs(command) > 2e-3 * peak))
    answer = 4.0 * max(np.abs(command[:still]).max(), 2e-3 * peak)
    offset = factor * answer / (share * (1.0 - np.cos(2.0 * np.pi * still * STEP)))
    start = examine_start(command, command + offset, step, frequency, WHITE, SLOW, share)
    assert start.offset == pytest.approx(offset)
    assert (start.offset_deviation < 0.1 * offset) == concludes
