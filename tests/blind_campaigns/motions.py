"""Motions and commands: synthetic accelerograms, real records of a folder, chirps, multisines."""

import re
from pathlib import Path

import numpy as np
from numba import njit
from scipy import signal

from blind_campaigns.system import Array

STANDARD_GRAVITY = 9.80665


@njit(error_model="numpy", cache=True)
def _ground_filter(white, omega, damping, interval):
    """Absolute acceleration of a layer of drifting frequency on a white-noise base (Kanai–Tajimi)."""
    out = np.empty(white.size)
    x, v = 0.0, 0.0
    for i in range(white.size):
        spring, dashpot = omega[i] * omega[i], 2.0 * damping * omega[i]
        # Semi-implicit in both terms: stable for any frequency below the sampling rate.
        v = (v - interval * (spring * x + white[i])) / (
            1.0 + interval * dashpot + interval * interval * spring
        )
        x += interval * v
        out[i] = -(dashpot * v + spring * x)
    return out


def _envelope(rng: np.random.Generator, time: Array) -> Array:
    """Return a rise and decay (t/tₚ)ᵃ·exp(a(1 − t/tₚ)) with peak 1, above a small floor of shaking."""
    share = time / time[-1]
    peak, sharpness = rng.uniform(0.12, 0.4), rng.uniform(1.0, 3.5)
    relative = share / peak
    pulse = relative**sharpness * np.exp(sharpness * (1.0 - relative))
    rise = np.clip(share / 0.03, 0.0, 1.0)
    return np.maximum(pulse, rng.uniform(0.05, 0.15) * rise)


def synthetic_accelerogram(rng: np.random.Generator, *, duration_s: float, rate_hz: float) -> Array:
    """Return a band-limited nonstationary accelerogram of unit peak: drifting Kanai–Tajimi, envelope."""
    time = np.arange(round(duration_s * rate_hz) + 1) / rate_hz
    first, last = rng.uniform(2.0, 6.0), rng.uniform(0.7, 2.0)
    omega = 2.0 * np.pi * first * (last / first) ** (time / time[-1])
    raw = _ground_filter(rng.normal(size=time.size), omega, rng.uniform(0.3, 0.7), 1.0 / rate_hz)
    low_cut, high_cut = rng.uniform(0.1, 0.25), rng.uniform(15.0, 25.0)
    band = signal.butter(2, [low_cut, high_cut], "bandpass", fs=rate_hz, output="sos")
    motion = signal.sosfilt(band, raw) * _envelope(rng, time)
    return motion / np.abs(motion).max()


def chirp(rng: np.random.Generator, *, duration_s: float, rate_hz: float) -> Array:
    """Return a linear sweep of unit amplitude from rest to 5–20 Hz."""
    time = np.arange(round(duration_s * rate_hz) + 1) / rate_hz
    return _tapered(np.sin(np.pi * rng.uniform(5.0, 20.0) * time**2 / time[-1]), time)


def multisine(rng: np.random.Generator, *, duration_s: float, rate_hz: float) -> Array:
    """Return sines of random phase, 0.1 to 3–10 Hz, falling with frequency, unit peak."""
    time = np.arange(round(duration_s * rate_hz) + 1) / rate_hz
    frequency = np.geomspace(0.1, rng.uniform(3.0, 10.0), 40) * rng.uniform(0.97, 1.03, 40)
    wave = np.zeros(time.size)
    for value, phase in zip(frequency, rng.uniform(0.0, 2.0 * np.pi, 40), strict=True):
        wave += np.sin(2.0 * np.pi * value * time + phase) / (1.0 + value)
    wave = _tapered(wave, time)
    return wave / np.abs(wave).max()


def _tapered(wave: Array, time: Array) -> Array:
    """Return a wave that fades in and out within a second."""
    return wave * np.clip(time, 0.0, 1.0) ** 2 * np.clip(time[-1] - time, 0.0, 1.0) ** 2


class RecordFolder:
    """Real records of a folder, PEER `.AT2` (in g) or two-column CSV (time, m/s²)."""

    def __init__(self, folder: Path) -> None:
        suffixes = {".at2", ".csv"}
        files = [
            path
            for path in folder.rglob("*")
            if path.suffix.lower() in suffixes and path.name != "catalog.csv"
        ]
        self.files = sorted(files)
        if not self.files:
            raise ValueError(f"a folder of records holds .AT2 or .csv files; {folder} holds none")

    def draw(self, rng: np.random.Generator, *, duration_s: float, rate_hz: float) -> tuple[str, Array]:
        """Return name and first `duration_s` of a random record, unit peak, linear between samples."""
        path = self.files[rng.integers(len(self.files))]
        time, motion = _read_peer(path) if path.suffix.lower() == ".at2" else _read_columns(path)
        grid = np.arange(round(min(duration_s, time[-1]) * rate_hz) + 1) / rate_hz
        motion = np.interp(grid, time, motion)
        return path.stem, motion / np.abs(motion).max()


def _read_peer(path: Path) -> tuple[Array, Array]:
    lines = path.read_text(encoding="ascii", errors="replace").splitlines()
    step = re.search(r"DT\s*=\s*([0-9.Ee+-]+)", lines[3])
    if step is None:
        raise ValueError(f"line 4 of a PEER record says DT=…; found {lines[3]!r} in {path.name}")
    motion = np.array(" ".join(lines[4:]).split(), dtype=float) * STANDARD_GRAVITY
    return np.arange(motion.size) * float(step.group(1)), motion


def _read_columns(path: Path) -> tuple[Array, Array]:
    time, motion = np.loadtxt(path, delimiter=",", skiprows=1, usecols=(0, 1), unpack=True)
    return time - time[0], motion
