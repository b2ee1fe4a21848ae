"""Simulated tests with known gain and delay, and the files a laboratory would keep them in."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from reliab.loop import delay_stepper
from reliab.loop.blocks import cut
from reliab.loop.excitation import Excitation
from reliab.loop.structure import Structure
from reliab.motions import Motion, load_motions
from reliab.validation.assessment import Recording

Simulate = Callable[..., Recording]


@pytest.fixture(scope="session")
def ground_motions() -> list[Motion]:
    """Six synthetic ground motions of three earthquakes."""
    return list(load_motions("synthetic")[:6])


@pytest.fixture(scope="session")
def simulate(ground_motions: list[Motion]) -> Simulate:
    """Simulate a test: motion number, structure, gain, delay, noise by its share of the RMS."""

    @cache
    def clean(motion: int, f: float, xi: float, gain: float, delay: float, rate: float):
        record = ground_motions[motion]
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
        rate: float = 512.0,
    ) -> Recording:
        command, measured, step = clean(motion, f, xi, gain, delay, rate)
        rng = np.random.default_rng(seed)
        size = np.sqrt(np.mean(measured**2))
        return Recording(
            command=command + command_noise * size * rng.normal(size=command.size),
            measured=measured + noise * size * rng.normal(size=command.size),
            time_step=step,
        )

    return make
