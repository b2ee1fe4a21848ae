"""A running test: the same numbers as afterwards, and a warning before it diverges."""

import time

import numpy as np
import pytest
from assessment.inference.simulated_loop import earthquake, simulate

from rebuilt_error.laboratory import DELAY, RATE, Lab, noise, run, synthetic_ground
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.assessment.inference.uncertain_quantity import PriorKnowledge
from reliab.assessment.monitor import Monitor
from reliab.assessment.rebuild import rebuild
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.structures.structure import Structure

STEP = 1.0 / RATE
STRUCTURE = Structure(frequency=1.0, damping_ratio=0.02)


@pytest.fixture(scope="module")
def outcome():
    return run(Lab(1.0, 0.02, 1.0, DELAY, (0.997, 0.001, 0.0, 0.0)), synthetic_ground(4, 15.0))


def feed_chunks(command, measured_displacement, chunks, **stated_values):
    monitor = Monitor(STRUCTURE, STEP, **stated_values)
    begin = 0
    for size in chunks:
        monitor.feed(command[begin : begin + size], measured_displacement[begin : begin + size])
        begin += size
    monitor.feed(command[begin:], measured_displacement[begin:])
    return monitor


@pytest.mark.usefixtures("all_draws")
@pytest.mark.default_cases(1)
@pytest.mark.parametrize("chunks", [(), (1, 2, 3, 500, 1, 9000)])
@pytest.mark.parametrize("lag", [0.0, 0.0023])
def test_the_history_is_the_one_rebuilt_afterwards(outcome, chunks, lag):
    measured_displacement = outcome.measured + noise(
        "white", outcome.measured.size, 1e-4, np.random.default_rng(0)
    )
    monitor = feed_chunks(outcome.command, measured_displacement, chunks, feedback_lag=lag)
    full_test = rebuild(outcome.command, measured_displacement, STEP, STRUCTURE, feedback_lag=lag)
    error = monitor.ask(draws=256)
    at_once = feed_chunks(outcome.command, measured_displacement, (), feedback_lag=lag).error
    assert np.abs(monitor.error - at_once).max() < 1e-9 * np.abs(at_once).max()
    assert (error.rms, error.mte) == (full_test.rms, full_test.mte)


def test_errors_so_far_are_those_of_the_history_so_far(outcome):
    monitor = feed_chunks(outcome.command, outcome.measured, (100, 4000))
    error = monitor.error
    square = np.trapezoid(error**2) / (error.size - 1)
    peak = np.abs(outcome.measured - error).max()
    assert monitor.now.rms == pytest.approx(np.sqrt(square) / peak, rel=1e-9)
    assert monitor.now.mte == pytest.approx(np.abs(error).max() / peak, rel=1e-9)


def test_later_offset_is_removed_from_all_earlier_samples(outcome):
    command = np.concatenate([np.zeros(1024), outcome.command])
    measured_displacement = np.concatenate([np.zeros(1024), outcome.measured]) + 0.02
    monitor = feed_chunks(command, measured_displacement, (5000,))
    monitor.ask()
    known = feed_chunks(command, measured_displacement - 0.02, (), sensor_offset=0.0)
    assert np.abs(monitor.error - known.error).max() < 1e-4 * np.abs(known.error).max()
    assert monitor.now.error == pytest.approx(known.now.error, rel=1e-3)


def test_later_equilibrium_applies_to_all_earlier_samples(outcome):
    """An offset that the loop felt before the test began moved the command the other way."""
    command = np.concatenate([np.zeros(1024), outcome.command]) - 0.02
    measured_displacement = np.concatenate([np.zeros(1024), outcome.measured])
    monitor = feed_chunks(command, measured_displacement, (5000,))
    monitor.ask()
    assert rebuild(command, measured_displacement, STEP, STRUCTURE).readings.starts[0].standing != 0.0
    true = outcome.measured - outcome.ideal
    assert np.abs(monitor.error[1024:] - true).max() < 1e-4 * np.abs(true).max()


def test_a_loop_that_will_diverge_is_known_before_its_motion_is_twice_the_exact_peak():
    late = run(Lab(1.0, 0.02, 1.0, DELAY, (1.0, 0.010, 0.0, 0.0)), synthetic_ground(4, 40.0))
    stop = int(np.argmax(np.abs(late.command) > 2.0 * np.abs(late.ideal).max()))
    monitor = feed_chunks(late.command[:stop], late.measured[:stop], (400,))
    expected = 0.02 - np.pi * 0.010
    assert monitor.now.damping.ratio == pytest.approx(expected, rel=0.1)
    assert monitor.gains_energy_since < stop * STEP


def test_stable_loop_keeps_the_damping_after_its_delay(outcome):
    monitor = feed_chunks(outcome.command, outcome.measured, (400,))
    assert monitor.gains_energy_since is None
    assert monitor.now.damping.ratio == pytest.approx(0.02 - np.pi * 0.001, rel=0.05)


def test_a_sample_takes_less_than_a_tenth_of_a_millisecond(outcome):
    # 20 µs on a free machine (tests/benchmarks/rebuilt_error.py measures it); this only sees a slip of kind
    monitor = feed_chunks(outcome.command[:2000], outcome.measured[:2000], ())
    begin = time.process_time()
    for first in range(2000, 12000, 64):
        monitor.feed(outcome.command[first : first + 64], outcome.measured[first : first + 64])
    assert (time.process_time() - begin) / 10000 < 1e-4


def test_bad_rows_are_refused():
    monitor = Monitor(STRUCTURE, STEP)
    with pytest.raises(InputError, match="the same length"):
        monitor.feed(np.zeros(3), np.zeros(2))
    with pytest.raises(InputError, match="the same length"):
        monitor.feed(np.zeros((2, 2)), np.zeros((2, 2)))
    for bad in (np.nan, np.inf, -1e31):
        with pytest.raises(InputError, match="finite"):
            monitor.feed(np.array([0.0, bad]), np.zeros(2))
        with pytest.raises(InputError, match="finite"):
            monitor.feed(np.zeros(2), np.array([0.0, bad]))
    assert monitor.samples == 0
    with pytest.raises(InputError, match="must have a sample"):
        _ = monitor.now


@pytest.fixture(scope="module")
def shaken():
    """A test of a structure that is not quite as stated, with its ground acceleration, and its noise."""
    test = simulate(
        frequency=1.02,
        damping_ratio=0.045,
        gain=0.99,
        delay=0.004,
        ground=earthquake(duration=24.0, time_step=1.0 / 256.0, seed=5),
        time_step=1.0 / 256.0,
        noise=1e-3,
    )
    return test, np.random.default_rng(2).standard_normal(test.ground.size)


@pytest.mark.parametrize("pieces", [1, 9])
def test_a_recorded_ground_acceleration_sharpens_the_running_intervals(shaken, pieces):
    test, white = shaken
    known = PriorKnowledge(
        stated={"f": StatedValue(1.0, 0.02), "xi": StatedValue(0.05, 0.01)}, equipment=ordinary_equipment()
    )
    channels = np.stack([test.command, test.measured, test.ground + 0.01 * white])

    def ask(factor):
        monitor = Monitor(Structure(frequency=1.0, damping_ratio=0.05), test.time_step, known=known)
        for command, measured, ground in np.array_split(channels, pieces, axis=1):
            monitor.feed(command, measured, None if factor is None else factor * ground)
        return monitor.ask()

    without, recorded, in_g = (ask(factor).rms for factor in (None, 1.0, 1.0 / 9.80665))
    assert without.low < test.rms < without.high
    assert recorded.low < test.rms < recorded.high
    assert recorded.high - recorded.low < 0.8 * (without.high - without.low)
    assert in_g == without  # in another unit, which is told at the end
