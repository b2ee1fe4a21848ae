"""Noise has the level, the colour and the lines that are asked for."""

import numpy as np
import pytest

from blind_campaigns.noise import KINDS, Noise, analogue, converted, draw_noise, expected_spectrum

RATE, COUNT = 1024.0, 45 * 1024


def noise_error(noise: Noise, rms: float) -> np.ndarray:
    rng = np.random.default_rng(5)
    clean = np.sin(2 * np.pi * 0.7 * np.arange(COUNT) / RATE)
    noisy = converted(clean + analogue(rng, COUNT, noise=noise, rms=rms, rate_hz=RATE), noise=noise, rms=rms)
    return noisy - clean


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("rms", [0.05, 0.005])
def test_level_is_as_prescribed(kind: str, rms: float) -> None:
    error = noise_error(draw_noise(np.random.default_rng(1), kind), rms)
    assert np.sqrt(np.mean(error**2)) == pytest.approx(rms, rel=0.08)


def test_coloured_noise_remembers_the_last_sample() -> None:
    error = noise_error(draw_noise(np.random.default_rng(1), "coloured"), 1.0)
    assert error[1:] @ error[:-1] / (error @ error) == pytest.approx(0.95, abs=0.01)


def test_mains_pickup_is_at_the_mains_and_its_harmonics() -> None:
    noise = draw_noise(np.random.default_rng(1), "mains")
    power = np.abs(np.fft.rfft(noise_error(noise, 1.0))) ** 2
    frequency = np.fft.rfftfreq(COUNT, 1 / RATE)
    near = np.zeros(frequency.size, bool)
    for order in noise.harmonics:
        near |= np.abs(frequency - order * noise.mains_hz) < 1.0
    assert power[near].sum() / power.sum() == pytest.approx(0.9, abs=0.02)


def test_quantised_values_are_whole_steps() -> None:
    noise = draw_noise(np.random.default_rng(1), "quantised")
    steps = converted(np.linspace(-1, 1, 999), noise=noise, rms=0.01) / (0.01 * np.sqrt(12))
    assert np.abs(steps - np.round(steps)).max() < 1e-9


def test_expected_spectrum_is_the_periodograms_mean() -> None:
    noise = Noise(kind="mixture", shares={"white": 0.3, "coloured": 0.7})
    power = np.abs(np.fft.rfft(noise_error(noise, 0.1))) ** 2 / COUNT
    reference = expected_spectrum(noise, 0.1, np.linspace(0, np.pi, power.size))
    for part in np.array_split(np.arange(1, power.size), 6):
        assert power[part].mean() == pytest.approx(reference[part].mean(), rel=0.1)
