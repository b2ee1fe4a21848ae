"""When a running test is judged, and its net damping, by the formulas of least squares."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from reliab.assessment.rebuilt_error import Monitor, Tolerances, rebuild
from reliab.assessment.rebuilt_error.stability_indicator import Damping, EnergyAlarm
from reliab.assessment.rebuilt_error.whole_structure import WholeStructure
from reliab.errors import InputError
from reliab.structures.structure import Structure
from reliab.vocabulary import Metric

STEP = 1.0 / 128.0
XI, SHARE, FREQUENCY = 0.04, 0.7, 1.25
W0 = 2.0 * np.pi * FREQUENCY
STRUCTURE = Structure(frequency=FREQUENCY, damping_ratio=XI, experimental_fraction=SHARE)
DAMPING = Damping.of_structure(WholeStructure.of_structure(STRUCTURE), STEP)
TIME = STEP * np.arange(1500)
COMMAND = 0.01 * np.sin(W0 * TIME) * (1.0 + 0.3 * np.sin(0.9 * TIME))


def moments_of(command, strayed, forgetting):
    """Forgetting sums of the products of x_c, x_c', one and x_m − x_c."""
    rows = np.stack([command, np.gradient(command, STEP), np.ones(command.size), strayed])
    weight = forgetting ** np.arange(command.size - 1, -1, -1)
    steps = np.diff(rows)
    return rows, weight, np.stack([(weight * rows) @ rows.T, (weight[1:] * steps) @ steps.T])


@pytest.mark.parametrize("slope", [-0.004, 0.003, 0.0])
def test_net_damping_is_that_of_the_velocity_in_the_error(slope):
    """ξ_net = ξ + αω₀b/2, whatever gain and offset do; its error is that of weighted least squares."""
    noise = 2e-5 * np.random.default_rng(1).standard_normal(TIME.size)
    strayed = -0.03 * COMMAND + slope * np.gradient(COMMAND, STEP) + 2e-3 + noise
    rows, weight, moments = moments_of(COMMAND, strayed, DAMPING.forgetting)
    found = DAMPING.net(moments, np.array([1000.0, moments[0, 1, 1]]))
    basis, power = rows[:3], np.sqrt(weight)
    values, rest, _, _ = np.linalg.lstsq((basis * power).T, strayed * power, rcond=None)
    assert found.ratio == pytest.approx(XI + 0.5 * SHARE * W0 * values[1])
    assert found.ratio == pytest.approx(XI + 0.5 * SHARE * W0 * slope, abs=2e-3)
    residual = rows[3] - values @ basis
    rough = min((weight[1:] @ np.diff(residual) ** 2) / (weight @ residual**2), 1.0)
    independent = weight.sum() * max(rough / (4.0 - rough), 4.0 * STEP * FREQUENCY)
    variance = np.linalg.inv((basis * weight) @ basis.T)[1, 1] * rest[0] / independent
    assert found.deviation == pytest.approx(0.5 * SHARE * W0 * np.sqrt(variance), rel=1e-6)


def test_more_windows_need_more_standard_errors_and_all_together_are_wrong_once_in_a_hundred():
    noise = 2e-5 * np.random.default_rng(2).standard_normal(TIME.size)
    _, _, moments = moments_of(COMMAND, noise, DAMPING.forgetting)
    allowed = []
    for window in range(1, 400):
        moved = (window - 0.5) * 2.0 * DAMPING.samples
        net = DAMPING.net(moments, np.array([moved, moments[0, 1, 1]]))
        allowed.append(scipy.stats.norm.sf((net.high - net.ratio) / net.deviation))
    assert allowed[0] == pytest.approx(0.005)
    assert np.all(np.diff(allowed) < 0.0)
    assert sum(allowed) == pytest.approx(0.01, rel=0.01)


def net_of(strayed, share=1.0):
    _, _, moments = moments_of(COMMAND, strayed, DAMPING.forgetting)
    return DAMPING.net(moments, np.array([1000.0, moments[0, 1, 1] / share]))


@pytest.mark.parametrize(("share", "large"), [(0.51, True), (0.49, False)])
def test_an_alarm_needs_half_of_the_largest_power(share, large):
    net = net_of(-4.0 * XI / (SHARE * W0) * np.gradient(COMMAND, STEP), share)
    assert net.large is large
    assert bool(EnergyAlarm(smallest=0.0).look(net, np.inf)) is large


def test_an_alarm_grants_play_of_twice_the_smallest_error():
    slope = -4.0 * XI / (SHARE * W0) * np.gradient(COMMAND, STEP)
    net = net_of(slope)
    weight = DAMPING.forgetting ** np.arange(TIME.size - 1, -1, -1)
    assert net.error == pytest.approx(np.sqrt(weight @ slope**2 / weight.sum()), rel=0.02)
    enough = -net.high / (2.2 * net.by_play)
    assert EnergyAlarm(smallest=0.99 * enough).look(net, np.inf)
    assert not EnergyAlarm(smallest=1.01 * enough).look(net, np.inf)
    assert not EnergyAlarm().look(net, np.inf)  # an error as large as ever may be play


@pytest.mark.parametrize(
    ("excess", "looks", "raised"), [(1.11, 1, True), (1.11, 2, True), (1.11, 3, False), (1.09, 1, False)]
)
def test_less_play_is_granted_where_the_command_has_lately_gone_beyond_the_exact_response(
    excess, looks, raised
):
    net = net_of(-4.0 * XI / (SHARE * W0) * np.gradient(COMMAND, STEP))
    alarm = EnergyAlarm(smallest=-net.high / (1.1 * net.by_play), following=-3)
    alarm.add(np.array([0.0, -excess]))
    raises = [alarm.look(net, 1.0) for _ in range(looks)]
    assert raises[-1] is raised


def test_a_piston_that_rests_within_its_play_tells_nothing_of_the_size_of_it():
    alarm = EnergyAlarm()
    rests, follows = (net_of(gain * COMMAND + 1e-4 * np.gradient(COMMAND, STEP)) for gain in (-0.9, -0.1))
    for net in [rests] * 3 + [follows, rests, follows]:  # it may only begin to move
        alarm.look(net, np.inf)
    assert alarm.smallest == np.inf
    alarm.look(follows, np.inf)
    assert 0.0 < alarm.smallest < 1e-4


@pytest.mark.parametrize("ratio", [2.0, 3.0, 5.0, 10.0, 40.0])
def test_play_takes_no_more_damping_away_than_is_granted(ratio):
    """A play operator by its definition: 2.2 times its smallest error bound what it does at any size."""
    half = 1e-3

    def of_play(amplitude):
        command = amplitude * np.sin(W0 * TIME)
        place, piston = 0.0, np.empty(TIME.size)
        for i, x in enumerate(command):
            place = piston[i] = min(max(place, x - half), x + half)
        _, _, moments = moments_of(command, piston - command, DAMPING.forgetting)
        return DAMPING.net(moments, np.array([1000.0, moments[0, 1, 1]]))

    smallest, net = of_play(2.0 * half).error, of_play(ratio * half)
    assert net.ratio < XI
    assert net.ratio + 2.2 * smallest * net.by_play > XI


def test_damping_waits_for_one_period_of_motion():
    _, _, moments = moments_of(COMMAND, 0.01 * COMMAND, DAMPING.forgetting)
    samples, power = 1.0 / (FREQUENCY * STEP), moments[0, 1, 1]
    assert DAMPING.net(moments, np.array([samples - 0.5, power])) is None
    assert DAMPING.net(moments, np.array([samples + 0.5, power])) is not None
    assert DAMPING.net(np.zeros((2, 4, 4)), np.array([1000.0, 0.0])) is None
    whole = replace(DAMPING, samples=100.0)
    assert whole.net(moments, np.array([99.0, power])) is None
    assert whole.net(moments, np.array([100.0, power])) is not None


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


def test_a_test_that_stands_still_is_not_due():
    still = Monitor(STRUCTURE, STEP)
    still.feed(np.zeros(5000), np.zeros(5000))
    assert not still.due
    assert (still.now.rms, still.now.mte, still.now.damping) == (0.0, 0.0, None)


def test_the_time_is_that_of_the_last_sample_and_one_sample_is_enough():
    monitor = fed(1)
    assert (monitor.samples, monitor.now.samples, monitor.now.time) == (1, 1, 0.0)
    assert fed(129).now.time == pytest.approx(1.0)


@pytest.mark.parametrize("metric", Metric)
def test_the_error_is_judged_by_the_low_end_and_when_its_peak_has_stood_for_12_s(metric):
    monitor = Monitor(STRUCTURE, STEP)
    time = STEP * np.arange(4000)
    command = np.minimum(time / 5.0, 1.0) * 0.01 * np.sin(W0 * time)
    measured = 0.98 * command + 1e-4 * np.random.default_rng(4).standard_normal(4000)
    assert not monitor.exceeds(1e-9, metric)
    monitor.feed(command[:2500], measured[:2500])
    assert not monitor.exceeds(1e-9, metric)
    low = monitor.ask(draws=8).estimate(metric).low
    assert monitor._running.calm >= 12.0  # noqa: SLF001
    assert monitor.exceeds(0.499 * low, metric)
    assert not monitor.exceeds(0.501 * low, metric)
    monitor.feed(10.0 * command[2500:2600], 10.0 * measured[2500:2600])
    assert not monitor.exceeds(1e-9, metric)


@pytest.fixture(scope="module")
def long():
    """A noisy test of 6,000 samples, of which one in one is swept."""
    rng = np.random.default_rng(6)
    time = STEP * np.arange(9000)
    command = 0.01 * np.sin(W0 * time) * (1.2 + np.sin(0.4 * time)) * np.clip(time / 3.0 - 1.0, 0.0, 1.0)
    command[6400:8700] = command[6400]  # a piston that rests for more than a stretch
    late = np.interp(time - 0.004, time, command)
    return command, 0.99 * late + 1e-4 * rng.standard_normal(time.size)


def estimates(long, whole, stretch):
    """Errors after the same samples: of a running test in stretches, and at once."""
    command, measured = (history[:whole] for history in long)
    tolerances = Tolerances(frequency=0.01)
    at_once = rebuild(command, measured, STEP, STRUCTURE, tolerances=tolerances, draws=64)
    monitor = Monitor(STRUCTURE, STEP, stretch=stretch, tolerances=tolerances)
    monitor.feed(command, measured)
    assert (monitor._before is None) == (whole <= 2 * stretch)  # noqa: SLF001
    error = monitor.ask(draws=64)
    return [(error.estimate(metric), at_once.estimate(metric)) for metric in Metric]


def test_a_test_of_two_stretches_has_the_interval_of_the_whole(long):
    for running, whole in estimates(long, 4000, 2000):
        assert running == whole


@pytest.mark.parametrize("whole", [6000, *(pytest.param(n, marks=pytest.mark.slow) for n in (8600, 9000))])
def test_a_longer_test_learns_its_frequency_from_two_stretches_and_has_the_error_of_the_whole(long, whole):
    for one, other in estimates(long, whole, 2000):
        assert one.value == pytest.approx(other.value, rel=0.03)
        width = other.high - other.low
        assert abs(one.low - other.low) < width
        assert abs(one.high - other.high) < width
        assert one.high - one.low < 2.0 * width


def test_a_rest_that_is_forgotten_still_counts_as_time():
    time = STEP * np.arange(3000)
    command = np.concatenate([np.zeros(3500), 0.01 * np.sin(W0 * time)])
    measured = 0.97 * command + 0.004
    monitor = Monitor(STRUCTURE, STEP, stretch=1000)
    monitor.feed(command, measured)
    error, whole = monitor.ask(draws=16), rebuild(command, measured, STEP, STRUCTURE, draws=16)
    assert error.start.offset == pytest.approx(whole.start.offset, rel=1e-3)
    assert error.rms.value == pytest.approx(whole.rms.value, rel=0.02)
    assert monitor.now.rms == pytest.approx(whole.rms.value, rel=0.02)


def test_a_lag_longer_than_what_is_kept_is_refused():
    with pytest.raises(InputError, match="shorter than a stretch"):
        Monitor(STRUCTURE, STEP, feedback_lag=1e9)


def test_more_draws_than_were_kept_are_refused():
    with pytest.raises(InputError, match="256 draws at most"):
        fed(1000).ask(draws=512)
