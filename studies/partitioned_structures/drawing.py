"""Partitioned tests drawn at random: structures and motions in turn, servos and their compensation."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from reliab.errors import InputError
from reliab.motions import Motion
from reliab.simulation.transfer_systems import TransferFunction

from .structures import partitioned_structures

RATE: Final = 4096.0
"""Sampling rate of the laboratory [Hz]."""


@dataclass(frozen=True, kw_only=True)
class PartitionedTest:
    """One test: structure, motion, and a servo with its compensation."""

    structure: str
    motion: Motion
    servo: TransferFunction
    inverse: tuple[float, ...]
    seed: int


def draw_tests(motions: Sequence[Motion], count: int, seed: int) -> list[PartitionedTest]:
    """Draw tests: structures and motions in turn, servos and compensations at random."""
    if not motions or count < 1:
        raise InputError("A study of partitioned tests needs motions and tests", value=f"{count} tests")
    generator = np.random.default_rng([seed, 18])
    names, tests = list(partitioned_structures()), []
    for number in range(count):
        frequency, damping = generator.uniform(12.0, 40.0), generator.uniform(0.5, 1.0)
        valve, gain = generator.uniform(60.0, 150.0), generator.normal(1.0, 0.01)
        delay, compensated = generator.uniform(0.0, 0.002), generator.uniform(0.85, 1.05)
        omega, pole = 2.0 * math.pi * frequency, 2.0 * math.pi * valve
        servo = TransferFunction.from_poles(
            [],
            [*np.roots([1.0, 2.0 * damping * omega, omega**2]), -pole],
            gain,
            static=True,
            delay=delay,
        )
        lag = 2.0 * damping / omega + 1.0 / pole + delay + 0.5 / RATE
        tests.append(
            PartitionedTest(
                structure=names[number % len(names)],
                motion=motions[number % len(motions)],
                servo=servo,
                inverse=(1.0, compensated * lag, 0.5 * (compensated * lag) ** 2),
                seed=1000 * seed + number,
            )
        )
    return tests
