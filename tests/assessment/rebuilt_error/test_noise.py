"""The sensor's noise: its spectrum, the filter and what rounding adds, by their definitions."""

import numpy as np
import pytest
import scipy

from reliab.assessment.rebuilt_error.noise import (
    CORNERS,
    SensorNoise,
    estimate_noise,
    follow_commands,
    white_floor,
)

STEP = 1.0 / 512.0


def autoregressive(corner, level, size, seed):
    """First-order autoregressive noise whose density at zero frequency is `level`, from its own past."""
    rho = np.exp(-2.0 * np.pi * corner * STEP)
    pushes = (1.0 - rho) * np.sqrt(level) * np.random.default_rng(seed).standard_normal(size + 4096)
    return scipy.signal.lfilter([1.0], [1.0, -rho], pushes)[4096:]


@pytest.mark.parametrize("place", range(len(CORNERS)))
def test_slow_noise_is_autoregressive(place):
    """Its mean square is level (1 − ρ)/(1 + ρ), its density that of its own recursion."""
    weights = np.zeros(1 + len(CORNERS))
    weights[1 + place] = 3e-8
    noise = SensorNoise(time_step=STEP, weights=weights, band=20.0)
    rho = np.exp(-2.0 * np.pi * CORNERS[place] * STEP)
    assert noise.slow == pytest.approx(np.sqrt(3e-8 * (1.0 - rho) / (1.0 + rho)), rel=1e-3)
    assert noise.white == 0.0
    assert noise.density(np.zeros(1))[0] == pytest.approx(3e-8)
    frequency = np.array([0.7, 11.0, 0.5 / STEP])
    transfer = (1.0 - rho) / (1.0 - rho * np.exp(-2j * np.pi * frequency * STEP))
    assert noise.density(frequency) == pytest.approx(3e-8 * np.abs(transfer) ** 2)


def test_white_noise_has_one_density():
    noise = SensorNoise(time_step=STEP, weights=np.array([4e-8, 0.0, 0.0, 0.0, 0.0, 0.0]), band=20.0)
    assert noise.white == pytest.approx(2e-4)
    assert noise.slow == 0.0
    assert noise.density(np.linspace(0.0, 256.0, 7)) == pytest.approx(np.full(7, 4e-8))


@pytest.mark.parametrize("band", [6.0, 40.0])
def test_filter_keeps_the_band_and_stops_higher_frequencies(band):
    noise = SensorNoise(time_step=STEP, weights=np.eye(6)[0], band=band)
    frequency = np.array([0.0, 0.3 * band, 0.9 * band, 1.7 * band, 3.0 * band])
    gain = np.abs(scipy.signal.freqz(noise.filter, worN=frequency, fs=1.0 / STEP)[1])
    assert gain[:3] == pytest.approx(1.0, abs=1e-3)
    assert gain[3:] == pytest.approx(0.0, abs=1e-3)
    assert noise.filter == pytest.approx(noise.filter[::-1])


def test_a_band_up_to_the_nyquist_frequency_is_not_filtered():
    """The edge of the filter lies 1.3 bands up; it must be below 0.9 of the Nyquist frequency."""
    history = np.random.default_rng(1).standard_normal(400)
    edges = 256.0 / 1.3 * np.array([0.89, 0.91])
    filtering, noise = (SensorNoise(time_step=STEP, weights=np.eye(6)[0], band=edge) for edge in edges)
    assert filtering.filter.size > 1
    assert noise.filter.tolist() == [1.0]
    np.testing.assert_array_equal(noise.smooth(history), history)


def test_straight_lines_and_slow_motions_pass_unchanged_up_to_the_ends():
    noise = SensorNoise(time_step=STEP, weights=np.eye(6)[0], band=25.0)
    time = STEP * np.arange(2048)
    line = 0.3 - 0.2 * time
    assert noise.smooth(line) == pytest.approx(line, abs=1e-9)
    wave = np.sin(2.0 * np.pi * 5.0 * time)
    middle = slice(noise.filter.size, -noise.filter.size)
    assert noise.smooth(wave)[middle] == pytest.approx(wave[middle], abs=2e-3)
    assert np.abs(noise.smooth(np.sin(2.0 * np.pi * 60.0 * time))[middle]).max() < 2e-3


def test_a_record_shorter_than_five_half_filters_is_not_filtered():
    noise = SensorNoise(time_step=STEP, weights=np.eye(6)[0], band=25.0)
    reach = noise.filter.size // 2
    history = np.random.default_rng(2).standard_normal(5 * reach + 1)
    assert np.abs(noise.smooth(history[:-1]) - history[:-1]).max() > 0.1
    np.testing.assert_array_equal(noise.smooth(history[:-2]), history[:-2])


@pytest.mark.parametrize("deviation", [1.0, 3e-5])
def test_the_floor_of_white_noise_is_its_mean_square(deviation):
    values = deviation * np.random.default_rng(4).standard_normal(40_000)
    assert white_floor(values) == pytest.approx(deviation**2, rel=0.03)


def shaken(size, seed=5):
    """A motion below 5 Hz under an envelope, 1 at its peak."""
    low = scipy.signal.butter(6, 4.0, fs=1.0 / STEP, output="sos")
    values = scipy.signal.sosfiltfilt(low, np.random.default_rng(seed).standard_normal(size))
    values *= np.sin(np.pi * np.arange(size) / size) ** 2
    return values / np.abs(values).max()


@pytest.mark.parametrize(("white", "corner", "slow"), [(1e-3, 3.0, 0.0), (3e-4, 10.0, 1e-5)])
def test_noise_comes_back_from_a_late_and_weak_actuator(white, corner, slow):
    size = 30_000
    command = shaken(size)
    noise = white * np.random.default_rng(6).standard_normal(size)
    noise += autoregressive(corner, slow, size, 7)
    measured_displacement = 0.99 * np.interp(np.arange(size) - 2.0, np.arange(size), command) + noise
    result = estimate_noise(command, measured_displacement, STEP)
    frequency = np.array([8.0, 20.0, 60.0, 200.0])
    rho = np.exp(-2.0 * np.pi * corner * STEP)
    transfer = (1.0 - rho) / (1.0 - rho * np.exp(-2j * np.pi * frequency * STEP))
    expected = white**2 + slow * np.abs(transfer) ** 2
    assert result.density(frequency) == pytest.approx(expected, rel=0.15)
    assert result.band > 3.0
    if slow == 0.0:  # slow noise above the white one is not told from motion
        assert result.band < 9.0


def test_the_mains_are_neither_noise_nor_motion():
    size = 30_000
    command = shaken(size)
    noise = 1e-3 * np.random.default_rng(8).standard_normal(size)
    mains = 5e-3 * np.sin(2.0 * np.pi * 50.0 * STEP * np.arange(size))
    with_mains, bare = (estimate_noise(command, command + noise + line, STEP) for line in (mains, 0.0))
    assert with_mains.white == pytest.approx(bare.white, rel=0.05)
    assert with_mains.band == pytest.approx(bare.band, rel=0.2)


def test_both_ends_of_a_record_are_continued_alike():
    """A record that is read backwards is smoothed to the same, read backwards."""
    noise = SensorNoise(time_step=STEP, weights=np.eye(6)[0], band=25.0)
    history = np.cumsum(np.random.default_rng(10).standard_normal(900))
    assert noise.smooth(history[::-1])[::-1] == pytest.approx(noise.smooth(history), abs=1e-9)


def test_parts_of_several_commands_are_kept_up_to_the_fastest():
    """Also where one moves slowly, and what is faster than both is noise that they must not explain."""
    time = STEP * np.arange(8192)
    swell = np.sin(np.pi * time / time[-1]) ** 2
    commands = np.stack([swell * np.sin(2.0 * np.pi * f * time) for f in (0.6, 14.0)])
    measured_displacement = 0.97 * commands[0] + 0.2 * commands[1]
    hiss = 0.3 * np.sin(2.0 * np.pi * 90.0 * time)
    is_inside = slice(1024, -1024)
    for disturbed in (measured_displacement, measured_displacement + hiss):
        result = follow_commands(commands, disturbed, STEP)
        np.testing.assert_allclose(result[is_inside], measured_displacement[is_inside], atol=0.01)
