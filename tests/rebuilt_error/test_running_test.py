"""When a running test is judged, and its net damping, by the formulas of least squares."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.loop.structure import Structure
from reliab.rebuilt_error import Monitor
from reliab.rebuilt_error.stability_indicator import Damping
from reliab.rebuilt_error.whole_structure import WholeStructure
from reliab.vocabulary import Metric

STEP = 1.0 / 128.0
XI, SHARE, FREQUENCY = 0.04, 0.7, 1.25
W0 = 2.0 * np.pi * FREQUENCY
STRUCTURE = Structure(frequency=FREQUENCY, damping_ratio=XI, experimental_fraction=SHARE)
DAMPING = Damping.of(WholeStructure.of(STRUCTURE), STEP)
TIME = STEP * np.arange(1500)
COMMAND = 0.01 * np.sin(W0 * TIME) * (1.0 + 0.3 * np.sin(0.9 * TIME))


def moments_of(command, strayed, forgetting):
    """Forgetting sums of the products of x_c, x_c', one and x_m − x_c."""
    rows = np.stack([command, np.gradient(command, STEP), np.ones(command.size), strayed])
    weight = forgetting ** np.arange(command.size - 1, -1, -1)
    return rows, weight, (weight * rows) @ rows.T


@pytest.mark.parametrize("slope", [-0.004, 0.003, 0.0])
def test_net_damping_is_that_of_the_velocity_in_the_error(slope):
    """ξ_net = ξ + αω₀b/2, whatever gain and offset do; its error is that of weighted least squares."""
    noise = 2e-5 * np.random.default_rng(1).standard_normal(TIME.size)
    strayed = -0.03 * COMMAND + slope * np.gradient(COMMAND, STEP) + 2e-3 + noise
    rows, weight, moments = moments_of(COMMAND, strayed, DAMPING.forgetting)
    found = DAMPING.net(moments, np.array([1000.0, moments[1, 1]]))
    basis, power = rows[:3], np.sqrt(weight)
    values, rest, _, _ = np.linalg.lstsq((basis * power).T, strayed * power, rcond=None)
    assert found.ratio == pytest.approx(XI + 0.5 * SHARE * W0 * values[1])
    assert found.ratio == pytest.approx(XI + 0.5 * SHARE * W0 * slope, abs=2e-3)
    independent = 4.0 * weight.sum() * STEP * FREQUENCY
    variance = np.linalg.inv((basis * weight) @ basis.T)[1, 1] * rest[0] / independent
    assert found.deviation == pytest.approx(0.5 * SHARE * W0 * np.sqrt(variance), rel=1e-6)


def test_an_alarm_needs_two_standard_errors_and_half_of_the_largest_power():
    noise = 2e-5 * np.random.default_rng(2).standard_normal(TIME.size)
    unused = -2.0 * XI / (SHARE * W0)
    for slope, share, alarm in ((2.0, 0.51, True), (2.0, 0.49, False), (0.9, 1.0, False)):
        strayed = slope * unused * np.gradient(COMMAND, STEP) + noise
        _, _, moments = moments_of(COMMAND, strayed, DAMPING.forgetting)
        found = DAMPING.net(moments, np.array([1000.0, moments[1, 1] / share]))
        assert found.unstable is alarm
    _, _, quiet = moments_of(COMMAND, unused * np.gradient(COMMAND, STEP) + noise, DAMPING.forgetting)
    at_limit = DAMPING.net(quiet, np.array([1000.0, quiet[1, 1]]))
    for standard_errors, alarm in ((1.9, False), (2.1, True)):
        ratio = DAMPING.ratio - at_limit.ratio - standard_errors * at_limit.deviation
        shifted = Damping(
            ratio=ratio, factor=DAMPING.factor, forgetting=DAMPING.forgetting, samples=DAMPING.samples
        )
        assert shifted.net(quiet, np.array([1000.0, quiet[1, 1]])).unstable is alarm


def test_damping_waits_for_one_period_of_motion():
    _, _, moments = moments_of(COMMAND, 0.01 * COMMAND, DAMPING.forgetting)
    samples = 1.0 / (FREQUENCY * STEP)
    assert DAMPING.net(moments, np.array([samples - 0.5, moments[1, 1]])) is None
    assert DAMPING.net(moments, np.array([samples + 0.5, moments[1, 1]])) is not None
    assert DAMPING.net(np.zeros((4, 4)), np.array([1000.0, 0.0])) is None
    whole = replace(DAMPING, samples=100.0)
    assert whole.net(moments, np.array([99.0, moments[1, 1]])) is None
    assert whole.net(moments, np.array([100.0, moments[1, 1]])) is not None


def fed(size, **stated):
    monitor = Monitor(STRUCTURE, STEP, **stated)
    command = 0.01 * np.sin(W0 * STEP * np.arange(size))
    monitor.feed(command, 0.98 * command)
    return monitor


def test_intervals_are_due_after_four_periods_and_again_after_half_as_much():
    four_periods = int(4.0 / (FREQUENCY * STEP))
    assert not fed(four_periods - 1).due
    monitor = fed(four_periods)
    assert monitor.due
    long = fed(2000)
    long.ask(draws=8)
    assert not long.due
    command = 0.01 * np.sin(W0 * STEP * np.arange(2000, 3001))
    long.feed(command[:999], 0.98 * command[:999])
    assert not long.due
    long.feed(command[999:1000], 0.98 * command[999:1000])
    assert long.due


def test_a_test_that_stands_still_or_is_too_long_is_not_due():
    still = Monitor(STRUCTURE, STEP)
    still.feed(np.zeros(5000), np.zeros(5000))
    assert not still.due
    assert (still.now.rms, still.now.mte, still.now.damping) == (0.0, 0.0, None)
    assert fed(1000, most_drawn=1000).answerable
    assert not fed(1001, most_drawn=1000).answerable
    assert not fed(1001, most_drawn=1000).due


def test_the_time_is_that_of_the_last_sample_and_one_sample_is_enough():
    monitor = fed(1)
    assert (monitor.samples, monitor.now.samples, monitor.now.time) == (1, 1, 0.0)
    assert fed(129).now.time == pytest.approx(1.0)


def test_a_threshold_is_exceeded_by_what_noise_does_not_explain():
    monitor = Monitor(STRUCTURE, STEP)
    command = np.minimum(STEP * np.arange(4000) / 5.0, 1.0) * 0.01 * np.sin(W0 * STEP * np.arange(4000))
    noise = 1e-4 * np.random.default_rng(4).standard_normal(4000)
    assert not monitor.exceeds(0.0)
    monitor.feed(command, 0.98 * command + noise)
    assert not monitor.exceeds(0.0)
    noise_of = monitor.ask(draws=8).noise
    level = np.hypot(noise_of.white, noise_of.slow)
    error = monitor.error
    ideal = np.abs(monitor._running.measured - monitor._running.offset - error).max()  # noqa: SLF001
    square = np.trapezoid(error**2) / (error.size - 1)
    limits = {
        Metric.RMS: np.sqrt(square - level**2) / ideal,
        Metric.MTE: (np.abs(error).max() - 4.0 * level) / ideal,
    }
    for metric, limit in limits.items():
        assert monitor.exceeds(0.999 * limit, metric)
        assert not monitor.exceeds(1.001 * limit, metric)


@pytest.mark.parametrize(("times", "judged"), [(20.0, False), (50.0, True)])
def test_a_motion_is_judged_from_twenty_times_the_noise(times, judged):
    """Far below resonance x_I is 0.61 of a command that is followed by half: 12 and 30 times the noise."""
    time = STEP * np.arange(4000)
    command = 0.01 * np.sin(2.0 * np.pi * 0.4 * time) * np.minimum(time / 5.0, 1.0)
    noise = 0.01 / times * np.random.default_rng(5).standard_normal(4000)
    monitor = Monitor(STRUCTURE, STEP)
    monitor.feed(command, 0.5 * command + noise)
    monitor.ask(draws=8)
    assert monitor.exceeds(0.01) is judged
