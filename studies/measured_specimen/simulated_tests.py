"""Hybrid tests of nonlinear specimens, simulated apart from the package's own loop and elements.

The loop is integrated by central differences at the sampling rate, the exact response by the same loop with
a perfect actuator.
"""

import math
from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.compiled import compiled

from .specimens import FAMILIES, PARAMETERS, STATES, resist


@compiled
def _run(
    law: int, parameters: Array, unit: float, substructures: Array, rig: Array, load: Array, step: float
) -> tuple[Array, Array, Array]:
    """Command, displacement of the specimen and its force under a load per unit mass; see `Loop.run`."""
    damping, stiffness, of_specimen = substructures
    gain, delay, lag, play, force_lag, attached, friction = rig
    state = np.zeros(STATES)
    command, moved, felt = np.zeros(load.size + 1), np.zeros(load.size), np.zeros(load.size)
    passes = step / (force_lag + step)  # whose delay is the lag
    sensed, speed = 0.0, 0.0
    follows = 1.0 - math.exp(-step / lag) if lag > 0.0 else 1.0
    whole = int(delay / step)
    part = delay / step - whole
    lagged, piston, last = 0.0, 0.0, 0.0
    for i in range(load.size):
        near = command[i - whole] if i >= whole else 0.0
        far = command[i - whole - 1] if i > whole else 0.0
        lagged += follows * ((1.0 - part) * near + part * far - lagged)
        aim = gain * lagged
        piston = min(max(piston, aim - play), aim + play)
        by = (piston - last) / unit
        last = piston
        moved[i] = piston
        force = of_specimen * unit * resist(law, piston / unit, by, by / step, step, state, parameters)
        was, speed = speed, by * unit / step
        sensed += passes * (force + attached * (speed - was) / step + friction * np.sign(speed) - sensed)
        felt[i] = sensed
        now, before = command[i], command[i - 1] if i > 0 else 0.0
        inertia = (2.0 * now - before) / step**2 + 0.5 * damping * before / step
        command[i + 1] = (inertia - stiffness * now - felt[i] + load[i]) / (
            1.0 / step**2 + 0.5 * damping / step
        )
    return command[:-1], moved, felt


@dataclass(frozen=True, kw_only=True)
class Actuator:
    """Gain [-], delay and lag [s] and play [m] of an actuator, what is between its force and the specimen."""

    gain: float = 1.0
    delay: float = 0.0
    lag: float = 0.0
    play: float = 0.0
    force_lag: float = 0.0  # s
    attached: float = 0.0  # mass between load cell and specimen, over that of the structure
    friction: float = 0.0  # in the load path, over the mass of the structure [m/s²]


@dataclass(frozen=True, kw_only=True)
class Loop:
    """A structure of unit mass with its specimen."""

    frequency: float
    damping_ratio: float
    share: float
    family: str
    parameters: list[float]
    yield_displacement: float

    def run(self, load: Array, step: float, actuator: Actuator) -> tuple[Array, Array, Array]:
        """Command, displacement of the specimen and its force under a load per unit mass."""
        turns = 2.0 * np.pi * self.frequency
        substructures = [
            2.0 * self.damping_ratio * turns,
            (1.0 - self.share) * turns**2,
            self.share * turns**2,
        ]
        rig = [
            *(actuator.gain, actuator.delay, actuator.lag, actuator.play),
            *(actuator.force_lag, actuator.attached, actuator.friction),
        ]
        parameters = np.zeros(PARAMETERS)
        parameters[: len(self.parameters)] = self.parameters
        law = FAMILIES[self.family][0]
        command, moved, felt = _run(
            law, parameters, self.yield_displacement, np.array(substructures), np.array(rig), load, step
        )
        if not np.isfinite(command).all():
            raise ArithmeticError("The loop diverges.")
        return command, moved, felt


@dataclass(frozen=True, kw_only=True)
class SimulatedTest:
    """A recorded test with its truth."""

    loop: Loop
    step: float
    command: Array
    measured: Array  # with noise
    force: Array  # with noise, per unit mass
    moved: Array  # the true displacement of the specimen
    exact: Array  # the response with a perfect actuator

    @property
    def error(self) -> float:
        """True RMS error over the peak of the exact response."""
        return float(np.sqrt(np.mean((self.moved - self.exact) ** 2)) / np.abs(self.exact).max())


def simulate(
    family: str,
    load: Array,
    step: float,
    draw: np.random.Generator,
    *,
    decibels: float = 40.0,
    **of_force: float,
) -> SimulatedTest:
    """Draw structure, specimen and actuator, run the test under a load, and record it with noise.

    `of_force`: `force_lag`, `attached` and `friction` of the actuator; it then has no play.
    """
    frequency = draw.uniform(0.5, 2.0)
    share, damping_ratio = draw.uniform(0.2, 1.0), draw.uniform(0.02, 0.05)
    of_linear = Loop(
        frequency=frequency,
        damping_ratio=damping_ratio,
        share=share,
        family="linear",
        parameters=[0.0],
        yield_displacement=1.0,
    )
    peak = float(np.abs(of_linear.run(load, step, Actuator())[0]).max())
    loop = Loop(
        frequency=frequency,
        damping_ratio=damping_ratio,
        share=share,
        family=family,
        parameters=FAMILIES[family][1](draw),
        yield_displacement=peak / draw.uniform(1.5, 5.0),
    )
    lag = float(draw.choice([0.0, 0.001, 0.003]))
    actuator = Actuator(
        gain=1.0 + 0.01 * draw.normal(),
        delay=max(abs(draw.normal()) * 0.004 / frequency - 0.8 * lag, 0.0),
        lag=lag,
        play=(0.0 if of_force else float(draw.choice([0.0, 0.0, 0.003]))) * loop.yield_displacement,
        **of_force,
    )
    exact = loop.run(load, step, Actuator())[0]
    command, moved, force = loop.run(load, step, actuator)
    noise = 10.0 ** (-decibels / 20.0)
    return SimulatedTest(
        loop=loop,
        step=step,
        command=command,
        measured=moved + noise * moved.std() * draw.standard_normal(moved.size),
        force=force + noise * force.std() * draw.standard_normal(force.size),
        moved=moved,
        exact=exact,
    )
