"""Simulated tests with known gain and delay, and the files a laboratory would keep them in."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from reliab.core.compiled import compiled
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.recordings.recording import Recording
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import delay_stepper
from reliab.simulation.linear_loop.blocks import cut
from reliab.structures.structure import Structure

Simulate = Callable[..., Recording]


@pytest.fixture(scope="module", autouse=True)
def assess_with_few_draws(few_draws: None) -> None:
    """Assess with few draws by default."""


@pytest.fixture(scope="session")
def whole_motions() -> list[Motion]:
    """Six synthetic ground motions of three earthquakes."""
    return list(load_motions("synthetic")[:6])


@pytest.fixture(scope="session")
def ground_motions(whole_motions: list[Motion]) -> list[Motion]:
    """Their first 40 s, with all of the strong shaking."""
    return [replace(motion, acceleration=motion.acceleration[:4001]) for motion in whole_motions]


@pytest.fixture(scope="session")
def simulate(whole_motions: list[Motion], ground_motions: list[Motion]) -> Simulate:
    """Simulate a test: motion number, structure, gain, delay, noise by its share of the RMS."""

    @cache
    def clean(motion: int, f: float, xi: float, gain: float, delay: float, rate: float, whole: bool):  # noqa: FBT001
        record = (whole_motions if whole else ground_motions)[motion]
        excitation = Excitation(acceleration=record.acceleration, time_step=record.time_step)
        structure = Structure(frequency=f, damping_ratio=xi)
        blocks = cut(excitation, structure, step=1.0 / rate)
        return *delay_stepper.response(blocks, structure, gain, delay), blocks.step

    def make(
        motion: int = 0,
        *,
        f: float = 1.0,
        xi: float = 0.02,
        gain: float = 0.996,
        delay: float = 0.0006,
        noise: float = 0.01,
        command_noise: float = 0.0,
        seed: int = 0,
        rate: float = 256.0,
        whole: bool = False,
    ) -> Recording:
        command, measured_displacement, step = clean(motion, f, xi, gain, delay, rate, whole)
        rng = np.random.default_rng(seed)
        size = np.sqrt(np.mean(measured_displacement**2))
        return Recording(
            command=command + command_noise * size * rng.normal(size=command.size),
            measured=measured_displacement + noise * size * rng.normal(size=command.size),
            time_step=step,
        )

    return make


@dataclass(frozen=True, kw_only=True, eq=False)
class Simulated:
    """Histories of a test and its true errors."""

    times: NDArray[np.float64]
    command: NDArray[np.float64]
    measured: NDArray[np.float64]
    ideal: NDArray[np.float64]
    ground: NDArray[np.float64]

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean((self.measured - self.ideal) ** 2)) / np.abs(self.ideal).max())


def solve_step_by_step(
    ground, step, *, f=1.0, xi=0.02, rate=256.0, seconds=None, db=60.0, seed=0, **rig
) -> Simulated:
    """Run the loop with and without errors of its rig, at 16384 steps a second or so."""
    ground = np.array(ground, dtype=np.float64)  # of one type for the kernel, whoever owns it
    stride = max(round(16384.0 / rate), 1)
    seconds = (ground.size - 1) * step if seconds is None else seconds
    names = ("gain", "lag", "delay", "backlash", "bias", "drift", "lead")
    values = {"gain": 1.0, **dict.fromkeys(names[1:], 0.0), **rig}
    structure = (2.0 * np.pi * f, xi, 1.0 / (stride * rate), seconds)
    command, measured_displacement, acceleration = _run(
        ground, step, structure, stride, tuple(values[name] for name in names)
    )
    perfect = _run(ground, step, structure, stride, (1.0, *(0.0,) * (len(names) - 1)))
    noise = (
        np.random.default_rng(seed).normal(size=measured_displacement.size)
        * np.std(measured_displacement)
        * 10.0 ** (-db / 20.0)
    )
    return Simulated(
        times=np.arange(command.size) / rate,
        command=command,
        measured=measured_displacement + noise,
        ideal=perfect[0],
        ground=acceleration,
    )


@compiled
def _run(ground, step, structure, stride, rig):
    circular, xi, dt, seconds = structure
    gain, lag, delay, backlash, bias, drift, lead = rig
    count = round(seconds / dt)
    histories = np.zeros((3, count // stride + 1))
    past = np.zeros(int(delay / dt) + 3)
    x, v, piston, play = 0.0, 0.0, 0.0, 0.0
    for k in range(count + 1):
        place = k * dt / step
        i = int(place)
        a = ground[i] + (place - i) * (ground[i + 1] - ground[i]) if i < ground.size - 1 else 0.0
        past[k % past.size] = gain * (x + lead * v)
        back = min(int(delay / dt), k)
        target = past[(k - back) % past.size] if delay > 0.0 else gain * (x + lead * v)
        piston += (target - piston) * (1.0 - np.exp(-dt / lag) if lag > 0.0 else 1.0)
        play = min(max(play, piston - 0.5 * backlash), piston + 0.5 * backlash)
        read = (play if backlash > 0.0 else piston) + bias + drift * k / count
        if k % stride == 0:
            histories[0, k // stride], histories[1, k // stride], histories[2, k // stride] = x, read, a
        v += dt * (-a - 2.0 * xi * circular * v - circular**2 * read)
        x += dt * v
    return histories


@pytest.fixture(scope="session")
def simulate_rig() -> Callable[..., Simulated]:
    """Solve a test with a faulty rig by code that shares nothing with the product."""
    return solve_step_by_step
