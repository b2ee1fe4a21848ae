"""Draw an imperfect world and write it as a campaign folder, with a further test that the campaign lacks."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import signal

from imperfect_worlds.actuators import ACTUATORS
from imperfect_worlds.specimens import SPECIMENS

RATE = 200.0
TESTS, HELD_OUT = 5, (3, 4)
WORLDS = (*SPECIMENS, *ACTUATORS)
FURTHER = "further.csv"
_FINE = 10  # steps of an actuator to a sample
_LARGEST_ERROR = 0.5  # of what the effect leaves to calibration, so that the effect is the dominant one


@dataclass(frozen=True, kw_only=True)
class World:
    """What is hidden in a campaign.

    Parameters
    ----------
    name : str
        Kind of world.
    block : str
        Part of the loop in which its effect acts.
    accepted : tuple of str
        Names of the library that stand for the dominant effect.
    model_error : float
        RMS of what no member of the library explains over that of the channel.
    """

    name: str
    block: str
    accepted: tuple[str, ...]
    model_error: float


def write_world(folder: Path, seed: int) -> World:
    """Write the campaign of a seed: campaign.toml, five tests, and one more test beside them.

    Parameters
    ----------
    folder : pathlib.Path
        Empty folder.
    seed : int
        Seed of all draws; kinds of worlds follow each other.

    Returns
    -------
    World
        What is hidden.
    """
    rng = np.random.default_rng(seed)
    name = WORLDS[seed % len(WORLDS)]
    error = float(np.exp(rng.uniform(np.log(0.02), np.log(0.2))))
    moved = _motions(rng, TESTS + 1)
    build = _specimen_tests if name in SPECIMENS else _actuator_tests
    columns, described, accepted, error = build(name, moved, error, rng)
    files = [f"test_{k}.csv" for k in range(TESTS)]
    lines = [f'name = "world {seed}"', described, "[sampling]", f"rate_hz = {RATE:g}"]
    for k, file in enumerate(files):
        held = str(k in HELD_OUT).lower()
        lines += ["[[tests]]", f'file = "{file}"', f'motion = "{k}"', f"held_out = {held}"]
    (folder / "campaign.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    for file, table in zip((*files, FURTHER), columns, strict=True):
        time = np.arange(len(next(iter(table.values())))) / RATE
        header = ",".join(("time_s", *table))
        rows = np.column_stack([time, *table.values()])
        np.savetxt(folder / file, rows, delimiter=",", header=header, comments="", fmt="%.9g")
    block = "specimen" if name in SPECIMENS else "actuator"
    return World(name=name, block=block, accepted=tuple(sorted(accepted)), model_error=error)


def _motions(rng, count):
    """Displacements of tests of one kind: a resonant answer to a strong phase, of differing strength."""
    centre = rng.uniform(0.6, 1.8)
    motions = []
    for _ in range(count):
        size = int(rng.uniform(16.0, 26.0) * RATE * _FINE)
        white = rng.normal(size=size)
        band = signal.butter(2, [0.6 * centre, 1.7 * centre], "bandpass", fs=RATE * _FINE, output="sos")
        swing = signal.sosfiltfilt(band, white)
        time = np.linspace(0.0, 1.0, size)
        swing *= np.sin(np.pi * time) ** 0.8 * (time > 0.0)
        motions.append(0.02 * rng.uniform(0.6, 1.0) * swing / np.abs(swing).max())
    return motions


def _disturbance(rng, time, x, v, reach, speed):
    """A smooth force or motion that no member of the library and no single term holds, of unit RMS."""
    memory = signal.lfilter([1.0 - 0.98], [1.0, -0.98], x / reach)
    parts = np.stack(
        [
            np.tanh(2.0 * memory) * (x / reach) ** 2,
            (x / reach) ** 3 * np.cos(3.0 * v / speed),
            np.sin(4.0 * x / reach) * (v / speed),
            np.abs(memory) * v / speed * (1.0 + time / time[-1]),
        ]
    )
    parts /= np.maximum(parts.std(axis=1, keepdims=True), 1e-12)
    return rng.dirichlet(np.ones(len(parts))) @ (rng.choice([-1.0, 1.0], size=(len(parts), 1)) * parts)


def _peaks(motions):
    velocities = [np.gradient(x, 1.0 / (RATE * _FINE)) for x in motions]
    return max(np.abs(x).max() for x in motions), max(np.abs(v).max() for v in velocities), velocities


def _below_effect(error, channels, calibrated):
    """Error, but no more than a share of what calibration leaves of the channels, over their RMS."""
    channel = np.concatenate(channels)
    columns = np.concatenate(calibrated, axis=1).T
    left = channel - columns @ np.linalg.lstsq(columns, channel, rcond=None)[0]
    return min(error, _LARGEST_ERROR * float(left.std() / channel.std()))


def _specimen_tests(name, motions, error, rng):
    equation, accepted = SPECIMENS[name]
    reach, speed, velocities = _peaks(motions)
    stiffness, dominant = 5e4, rng.uniform(0.25, 0.7)
    shape, disturbed, noise = rng.integers(2**31), rng.integers(2**31), 0.003 * stiffness * reach
    factor = dominant * stiffness * reach * (1.0 if name != "bilinear_gap" else 1.0 / dominant)
    parts = []
    for fine, speeds in zip(motions, velocities, strict=True):
        x, v = fine[::_FINE], speeds[::_FINE]
        time = np.arange(x.size) / RATE
        effect = equation(time, x, v, reach, speed, np.random.default_rng(shape))
        parts.append((time, x, v, stiffness * x + factor * effect))
    error = _below_effect(error, [p[3] for p in parts], [p[1][np.newaxis] for p in parts])
    tables = []
    for time, x, v, exact in parts:
        added = _disturbance(np.random.default_rng(disturbed), time, x, v, reach, speed)
        force = exact + error * exact.std() * added / max(added.std(), 1e-12)
        force = force + noise * rng.normal(size=x.size)
        tables.append({"measured_m": x + 1e-4 * reach * rng.normal(size=x.size), "force_n": force})
    described = (
        f"[specimen]\nstiffness_n_per_m = {stiffness * rng.uniform(0.96, 1.04):g}\n"
        "damping_n_s_per_m = 0.0\nmass_kg = 0.0"
    )
    return tables, described, accepted, error


def _actuator_tests(name, motions, error, rng):
    equation, accepted = ACTUATORS[name]
    reach, speed, velocities = _peaks(motions)
    shape, disturbed, delay = rng.integers(2**31), rng.integers(2**31), int(rng.uniform(5, 20))
    parts = []
    for u, v in zip(motions, velocities, strict=True):
        moved = equation(1.0 / (RATE * _FINE), u, reach, speed, np.random.default_rng(shape))
        parts.append((u, v, np.concatenate([np.full(delay, moved[0]), moved[:-delay]])))
    error = _below_effect(error, [p[2] for p in parts], [np.stack(p[:2]) for p in parts])
    tables = []
    for u, v, exact in parts:
        time = np.arange(u.size) / (RATE * _FINE)
        added = _disturbance(np.random.default_rng(disturbed), time, u, v, reach, speed)
        read = (exact + error * exact.std() * added / max(added.std(), 1e-12))[::_FINE]
        tables.append(
            {"command_m": u[::_FINE], "measured_m": read + 0.002 * reach * rng.normal(size=read.size)}
        )
    described = f"[actuator]\ngain = 1.0\ndelay_s = {delay / (RATE * _FINE):g}"
    return tables, described, accepted, error
