"""Noise that laboratories have: white, coloured, mains pickup, quantisation, and mixtures."""

from dataclasses import dataclass, field

import numpy as np
from scipy import signal

from blind_campaigns.system import Array

AUTOREGRESSION = 0.95
KINDS = ("white", "coloured", "mains", "quantised", "mixture")


@dataclass(frozen=True, kw_only=True)
class Noise:
    """Noise of one campaign: shares of the noise power, and what the channels have in common."""

    kind: str
    shares: dict[str, float]
    mains_hz: float = 50.0
    harmonics: dict[int, float] = field(default_factory=dict)


def draw_noise(rng: np.random.Generator, kind: str) -> Noise:
    """Return noise of a kind; pickup rides on a tenth of white noise, mixtures have random shares."""
    shares = {"white": {"white": 1.0}, "coloured": {"coloured": 1.0}, "mains": {"white": 0.1, "mains": 0.9}}
    shares["quantised"] = {"quantised": 1.0}
    parts = rng.dirichlet(np.ones(4))
    shares["mixture"] = dict(zip(("white", "coloured", "mains", "quantised"), map(float, parts), strict=True))
    amplitudes = [1.0, *rng.uniform(0.0, 0.5, 3)]
    harmonics = dict(zip((1, 2, 3, 5), map(float, amplitudes), strict=True))
    return Noise(
        kind=kind, shares=shares[kind], mains_hz=float(rng.choice([50.0, 60.0])), harmonics=harmonics
    )


def analogue(rng: np.random.Generator, count: int, *, noise: Noise, rms: float, rate_hz: float) -> Array:
    """Return the part of the noise that is added to the signal before the converter."""
    added = np.zeros(count)
    for part, make in (("white", _white), ("coloured", _coloured), ("mains", _mains)):
        share = noise.shares.get(part, 0.0)
        if share > 0.0:
            added += rms * np.sqrt(share) * make(rng, count, noise, rate_hz)
    return added


def converted(values: Array, *, noise: Noise, rms: float) -> Array:
    """Return values as the converter records them: its steps give the quantised share of the noise."""
    share = noise.shares.get("quantised", 0.0)
    return quantise(values, rms * np.sqrt(12.0 * share)) if share * rms > 0.0 else values


def quantise(values: Array, step: float) -> Array:
    """Return values rounded to whole steps of the converter."""
    return np.round(values / step) * step


def _white(rng: np.random.Generator, count: int, _noise: Noise, _rate_hz: float) -> Array:
    return rng.normal(size=count)


def _coloured(rng: np.random.Generator, count: int, _noise: Noise, _rate_hz: float) -> Array:
    """Return a stationary first-order autoregressive sequence of unit variance."""
    shocks = rng.normal(size=count) * np.sqrt(1.0 - AUTOREGRESSION**2)
    shocks[0] = rng.normal()
    return signal.lfilter([1.0], [1.0, -AUTOREGRESSION], shocks)


def _wander(rng: np.random.Generator, count: int, rate_hz: float, seconds: float) -> Array:
    """Return a slow stationary Gaussian process of unit variance and the given memory."""
    memory = np.exp(-1.0 / (rate_hz * seconds))
    shocks = rng.normal(size=count) * np.sqrt(1.0 - memory**2)
    shocks[0] = rng.normal()
    return signal.lfilter([1.0], [1.0, -memory], shocks)


def _mains(rng: np.random.Generator, count: int, noise: Noise, rate_hz: float) -> Array:
    """Return hum of unit variance, its amplitude and phase wandering over ten seconds."""
    frequency = noise.mains_hz + rng.normal(scale=0.02)
    phase = 2.0 * np.pi * frequency * np.arange(count) / rate_hz + rng.uniform(0.0, 2.0 * np.pi)
    phase += 0.3 * _wander(rng, count, rate_hz, 10.0)
    hum = np.zeros(count)
    for order, amplitude in noise.harmonics.items():
        if order * noise.mains_hz < 0.5 * rate_hz:
            hum += amplitude * np.sin(order * phase + rng.uniform(0.0, 2.0 * np.pi))
    hum *= np.exp(0.15 * _wander(rng, count, rate_hz, 10.0))
    return hum / np.sqrt(np.mean(hum**2))


def expected_spectrum(noise: Noise, rms: float, angle: Array) -> Array:
    """Return the power at digital frequencies `angle` [rad/sample] as the variance of equivalent white noise.

    Mains pickup is left out: a line can be notched.
    """
    coloured = (1.0 - AUTOREGRESSION**2) / np.abs(1.0 - AUTOREGRESSION * np.exp(-1j * angle)) ** 2
    flat = noise.shares.get("white", 0.0) + noise.shares.get("quantised", 0.0)
    return rms**2 * (flat + noise.shares.get("coloured", 0.0) * coloured)
