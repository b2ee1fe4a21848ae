"""When a running test is judged, and its net damping, by the formulas of least squares."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from reliab.assessment.inference.uncertain_quantity import PriorKnowledge
from reliab.assessment.monitor import Monitor
from reliab.assessment.rebuild import rebuild
from reliab.assessment.rebuilt_error.loop_energy import EnergyAlarm, net_damping, select_modes
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

STEP = 1.0 / 128.0
XI, SHARE, FREQUENCY = 0.04, 0.7, 1.25
W0 = 2.0 * np.pi * FREQUENCY
STRUCTURE = Structure(frequency=FREQUENCY, damping_ratio=XI, experimental_fraction=SHARE)
(MODE,) = select_modes(Partition.from_structure(STRUCTURE), STEP)
TIME = STEP * np.arange(1500)
COMMAND = 0.01 * np.sin(W0 * TIME) * (1.0 + 0.3 * np.sin(0.9 * TIME))


def sums_of(command, error, *, moving_samples=1000.0, share=1.0):
    """Forgetting sums of the products of x_c, x_c' and x_m − x_c; `share` of the largest power."""
    rows = np.stack([command, np.gradient(command, STEP), error])
    weight = MODE.forgetting ** np.arange(command.size - 1, -1, -1)
    steps = np.diff(rows)
    moments = np.stack([(weight * rows) @ rows.T, (weight[1:] * steps) @ steps.T])
    return moments, np.array([weight.sum(), moving_samples, moments[0, 1, 1] / share])


def net_of_sums(mode, sums, modes):
    moments, totals = sums
    return net_damping(mode, moments, totals, modes)


def net_of(error, **options):
    return net_of_sums(MODE, sums_of(COMMAND, error, **options), 1)


@pytest.mark.parametrize("slope", [-0.004, 0.003, 0.0])
def test_net_damping_equals_the_pole_with_the_error(slope):
    """s² + 2ξω₀s + ω₀² + αω₀²(a + b s) = 0; its error is that of weighted least squares."""
    noise = 2e-5 * np.random.default_rng(1).standard_normal(TIME.size)
    velocity = np.gradient(COMMAND, STEP)
    error = -0.03 * COMMAND + slope * velocity + noise
    result = net_of(error)
    weight = MODE.forgetting ** np.arange(TIME.size - 1, -1, -1)
    basis, power = np.stack([COMMAND, velocity]), np.sqrt(weight)
    (a, b), remainder, _, _ = np.linalg.lstsq((basis * power).T, error * power, rcond=None)
    pole = np.roots([1.0, 2.0 * XI * W0 + SHARE * W0**2 * b, W0**2 * (1.0 + SHARE * a)])[0]
    assert result.ratio == pytest.approx(-pole.real / W0)
    assert result.ratio == pytest.approx(XI + 0.5 * SHARE * W0 * slope, abs=2e-3)
    residual = error - np.array([a, b]) @ basis
    rough = min((weight[1:] @ np.diff(residual) ** 2) / (weight @ residual**2), 1.0)
    independent = weight.sum() * max(rough / (4.0 - rough), 8.0 * STEP * FREQUENCY)
    variance = np.linalg.inv((basis * weight) @ basis.T)[1, 1] * remainder[0] / independent
    assert result.deviation == pytest.approx(0.5 * SHARE * W0 * np.sqrt(variance), rel=0.02)


@pytest.mark.parametrize(
    ("share", "noise", "near"), [(0.1, 1e-6, True), (0.5, 1e-6, False), (0.1, 1e-3, False)]
)
def test_a_loop_is_near_instability_where_noise_does_not_explain_the_damping_that_it_lost(share, noise, near):
    """With a tenth of the damping left; where noise leaves the damping open it is not said."""
    slope = 2.0 * XI * (share - 1.0) / (SHARE * W0)
    rng = np.random.default_rng(2)
    error = slope * np.gradient(COMMAND, STEP) + noise * rng.standard_normal(TIME.size)
    assert net_of(error).near is near


@pytest.mark.slow
def test_more_windows_need_more_standard_errors_and_all_together_are_wrong_once_in_a_hundred():
    noise = 2e-5 * np.random.default_rng(2).standard_normal(TIME.size)
    for modes in (1, 3):
        allowed = []
        for window in range(1, 400):
            net = net_of_sums(
                MODE, sums_of(COMMAND, noise, moving_samples=(window - 0.5) * 3.0 * MODE.samples), modes
            )
            allowed.append(scipy.stats.norm.sf((net.high - net.ratio) / net.deviation))
        assert allowed[0] == pytest.approx(0.005 / modes)
        assert np.all(np.diff(allowed) < 0.0)
        assert modes * sum(allowed) == pytest.approx(0.01, rel=0.01)


@pytest.mark.parametrize(("share", "large"), [(0.51, True), (0.49, False)])
def test_an_alarm_needs_half_of_the_largest_power(share, large):
    net = net_of(-4.0 * XI / (SHARE * W0) * np.gradient(COMMAND, STEP), share=share)
    assert bool(net.large) is large
    assert EnergyAlarm(smallest=0.0).look(net) is large


def test_alarm_needs_an_error_above_noise():
    slope = -4.0 * XI / (SHARE * W0) * np.gradient(COMMAND, STEP)
    noise = np.random.default_rng(4).standard_normal(TIME.size)
    reference = [bool(net_of(slope + level * noise).known) for level in (1e-5, 1e-3, 1e-1)]
    assert reference == [True, True, False]
    assert EnergyAlarm(smallest=0.0).look(replace(net_of(slope), known=True))
    assert not EnergyAlarm(smallest=0.0).look(replace(net_of(slope), known=False))


def test_alarm_grants_more_than_the_apparent_play():
    net = net_of(-8.0 * XI / (SHARE * W0) * np.gradient(COMMAND, STEP))
    shares = np.linspace(0.0, 1.0, 101)
    granted = np.array([net.damping_loss(share * net.amplitude) for share in shares])
    assert np.all(granted >= SHARE / (2.0 * np.pi) * np.where(shares < 0.5, 4.0 * shares * (1 - shares), 1.0))
    enough = net.amplitude * shares[np.argmax(net.high + granted > 0.0)]
    assert 0.0 < enough < 0.5 * net.amplitude
    assert EnergyAlarm(smallest=0.9 * enough).look(net)
    assert not EnergyAlarm(smallest=enough).look(net)
    assert not EnergyAlarm().look(net)  # an error as large as ever may be play


def test_a_piston_that_rests_within_its_play_tells_nothing_of_the_size_of_it():
    alarm = EnergyAlarm()
    rests, follows = (net_of(gain * COMMAND + 1e-4 * np.gradient(COMMAND, STEP)) for gain in (-0.9, -0.1))
    for net in [rests] * 3 + [follows, rests, follows]:  # it may only begin to move
        alarm.look(net)
    assert alarm.smallest == np.inf
    alarm.look(follows)
    assert 0.0 < alarm.smallest < 1e-4


@pytest.mark.parametrize("ratio", [2.0, 3.0, 5.0, 10.0, 40.0])
@pytest.mark.parametrize("first", [2.0, 4.0])
def test_play_takes_no_more_damping_away_than_is_granted(first, ratio):
    """A play operator by its definition, of which the error at one size bounds what it does at any other."""
    half = 1e-3

    def of_play(amplitude):
        command = amplitude * np.sin(W0 * TIME)
        place, piston = 0.0, np.empty(TIME.size)
        for i, x in enumerate(command):
            place = piston[i] = min(max(place, x - half), x + half)
        return net_of_sums(MODE, sums_of(command, piston - command), 1)

    smallest, net = of_play(first * half).play, of_play(ratio * half)
    assert net.ratio < XI
    assert net.ratio + net.damping_loss(smallest) > XI


def test_damping_waits_for_one_period_of_motion():
    samples = 1.0 / (FREQUENCY * STEP)
    assert net_of(0.01 * COMMAND, moving_samples=samples - 0.5) is None
    assert net_of(0.01 * COMMAND, moving_samples=samples + 0.5) is not None
    still = np.zeros((2, 3, 3)), np.array([1.0, 1000.0, 0.0])
    assert net_of_sums(MODE, still, 1) is None


def frame_of(share):
    """Two storeys of which the lower one is in the laboratory, by a share."""
    stiffness = 400.0 * np.array([[2.0, -1.0], [-1.0, 1.0]])
    damping = 0.02 * stiffness / 12.0
    return Partition(
        mass=np.eye(2),
        damping=damping,
        stiffness=stiffness,
        interface=np.array([1.0, 0.0]),
        specimen_stiffness=share * 400.0,
    )


@pytest.mark.parametrize("place", [0, 1])
def test_net_damping_of_a_frame_mode_equals_its_pole(place):
    """The error moves the other mode as well, by whose motion it is changed."""
    frame = frame_of(0.6)
    mode = next(single for single in select_modes(frame, STEP) if single.place == place)
    a, b = -0.1, -0.02
    error = frame.interface @ frame.specimen_stiffness @ frame.interface.T
    full_test, coupled_test = frame.stiffness + a * error, frame.damping + b * error
    companion = np.block([[np.zeros((2, 2)), np.eye(2)], [-full_test, -coupled_test]])
    exact = np.sort_complex(np.linalg.eigvals(companion))
    exact = exact[exact.imag > 0.0][np.argsort(exact[exact.imag > 0.0].imag)][place]
    time = STEP * np.arange(4000)
    command = np.exp(exact.real * (time - time[-1])) * np.sin(exact.imag * time)
    rows = np.stack([command, np.gradient(command, STEP)])
    result = net_of_sums(mode, sums_of(command, a * rows[0] + b * rows[1]), 2)
    assert result.ratio == pytest.approx(-exact.real / mode.circular_frequency, rel=1e-3, abs=1e-5)


def test_the_mode_with_the_shortest_critical_delay_comes_first_and_no_more_than_three_are_watched():
    stiffness = 400.0 * (2.0 * np.eye(8) - np.eye(8, k=1) - np.eye(8, k=-1))
    structure = Partition(
        mass=np.eye(8),
        damping=0.01 * stiffness,
        stiffness=stiffness,
        interface=np.eye(8)[0],
        specimen_stiffness=200.0,
    )
    modes = select_modes(structure, 1e-3)
    delays = [2.0 * mode.ratio * mode.circular_frequency / mode.stiffness for mode in modes]
    assert len(modes) == 3
    assert delays == sorted(delays)
    coarse = select_modes(structure, 0.1)
    assert [mode.place for mode in coarse] == [0]  # a period of the others has fewer than five samples


def fed(size, **stated_values):
    monitor = Monitor(STRUCTURE, STEP, **stated_values)
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


def test_test_at_rest_is_not_due():
    still = Monitor(STRUCTURE, STEP)
    still.feed(np.zeros(5000), np.zeros(5000))
    assert not still.due
    assert (still.now.rms, still.now.mte, still.now.damping) == (0.0, 0.0, None)


def test_time_of_the_last_sample_counts_and_one_sample_is_enough():
    monitor = fed(1)
    assert (monitor.samples, monitor.now.samples, monitor.now.time) == (1, 1, 0.0)
    assert fed(129).now.time == pytest.approx(1.0)


@pytest.mark.parametrize("metric", Metric)
def test_the_error_is_judged_by_the_low_end_and_when_its_peak_has_stood_for_12_s(metric):
    monitor = Monitor(STRUCTURE, STEP)
    time = STEP * np.arange(4000)
    command = np.minimum(time / 5.0, 1.0) * 0.01 * np.sin(W0 * time)
    measured_displacement = 0.98 * command + 1e-4 * np.random.default_rng(4).standard_normal(4000)
    assert not monitor.exceeds(1e-9, metric)
    monitor.feed(command[:2500], measured_displacement[:2500])
    assert not monitor.exceeds(1e-9, metric)
    low = monitor.ask(draws=8).estimate(metric).low
    assert monitor._running.sums[0].calm * STEP >= 12.0  # noqa: SLF001
    assert monitor.exceeds(0.499 * low, metric)
    assert not monitor.exceeds(0.501 * low, metric)
    monitor.feed(10.0 * command[2500:2600], 10.0 * measured_displacement[2500:2600])
    assert not monitor.exceeds(1e-9, metric)


@pytest.fixture(scope="module")
def long():
    """A noisy test at eight times the rate, of 9,000 samples of which one in eight resolves its structure."""
    rng = np.random.default_rng(6)
    time = STEP / 8.0 * np.arange(72_000)
    command = 0.01 * np.sin(W0 * time) * (1.2 + np.sin(0.4 * time)) * np.clip(time / 3.0 - 1.0, 0.0, 1.0)
    command[51_200:69_600] = command[51_200]  # a piston that rests for more than a stretch
    late = np.interp(time - 0.004, time, command)
    return command, 0.99 * late + 1e-4 * rng.standard_normal(time.size)


@pytest.mark.parametrize(
    "samples", [32_000, 48_000, *(pytest.param(n, marks=pytest.mark.slow) for n in (68_800, 72_000))]
)
def test_a_long_test_has_the_interval_of_the_whole(long, samples):
    """Held at a lower rate, and its first stretch forgotten, but for sums over it."""
    command, measured_displacement = (history[:samples] for history in long)
    tolerances = PriorKnowledge(tolerances={"frequency": 0.01})
    step = STEP / 8.0
    whole = rebuild(command, measured_displacement, step, STRUCTURE, known=tolerances, draws=64)
    monitor = Monitor(STRUCTURE, step, stretch=16_000, known=tolerances)
    monitor.feed(command, measured_displacement)
    error = monitor.ask(draws=64)
    assert monitor.is_whole == (samples <= 32_000)
    assert error.command.shape[1] <= 16_000
    for metric in Metric:
        single, second = error.estimate(metric), whole.estimate(metric)
        width = second.high - second.low
        assert single.value == pytest.approx(second.value, rel=0.03)
        assert abs(single.low - second.low) < 0.5 * width
        assert abs(single.high - second.high) < 0.5 * width


def test_forgotten_rest_still_counts_as_time():
    time = STEP * np.arange(3000)
    command = np.concatenate([np.zeros(3500), 0.01 * np.sin(W0 * time)])
    measured_displacement = 0.97 * command + 0.004
    monitor = Monitor(STRUCTURE, STEP, stretch=1000)
    monitor.feed(command, measured_displacement)
    error, full_test = (
        monitor.ask(draws=16),
        rebuild(command, measured_displacement, STEP, STRUCTURE, draws=16),
    )
    assert error.readings.starts[0].offset == pytest.approx(full_test.readings.starts[0].offset, rel=1e-3)
    assert error.rms.value == pytest.approx(full_test.rms.value, rel=0.02)
    assert monitor.now.rms == pytest.approx(full_test.rms.value, rel=0.02)


def test_a_lag_longer_than_what_is_kept_is_refused():
    with pytest.raises(InputError, match="shorter than a stretch"):
        Monitor(STRUCTURE, STEP, feedback_lag=1e9)


def test_more_draws_than_were_kept_are_refused():
    with pytest.raises(InputError, match="256 draws at most"):
        fed(1000).ask(draws=512)


def test_no_error_is_stated_of_the_noise_in_a_rest_before_the_motion():
    """A good test that begins after 25 s of rest: the error of noise over no motion is no error."""
    rng = np.random.default_rng(3)
    time = STEP * np.arange(4000)
    motion = 0.01 * np.sin(W0 * time) * np.minimum(time / 6.0, 1.0)
    command = np.concatenate([1e-9 * rng.standard_normal(3200), motion])
    measured_displacement = 0.997 * command + 2e-5 * rng.standard_normal(command.size)
    monitor, stated_at_rest = Monitor(STRUCTURE, STEP), []
    for begin in range(0, command.size, 64):
        monitor.feed(command[begin : begin + 64], measured_displacement[begin : begin + 64])
        if monitor.due:
            monitor.ask(draws=16)
        stated_at_rest.append(begin < 3200 and monitor.result is not None)
        assert not monitor.exceeds(0.05)
    assert not any(stated_at_rest)
    assert monitor.result.estimate(Metric.RMS).value < 0.05


def test_unknown_skew_is_no_gain_of_energy():
    """Recorded half a sample late the loop seems to gain energy; if it is later than that, it does."""
    velocity = np.gradient(COMMAND, STEP)
    skew = 0.5 * STEP
    uncertain = replace(MODE, skew=skew / np.sqrt(3.0))
    for late, alarms in ((0.0, False), (skew, False), (5.0 * skew, True)):
        delay = 2.0 * 0.95 * XI / (SHARE * W0) + late  # five per cent before instability
        sums = sums_of(COMMAND, -delay * velocity)
        assert bool(net_of_sums(MODE, sums, 1).high < 0.0) is (late > 0.0)
        assert bool(net_of_sums(uncertain, sums, 1).high < 0.0) is alarms
