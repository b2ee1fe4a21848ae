# ruff: noqa: ARG001 - every family takes the same arguments
"""Hybrid tests of nonlinear specimens, simulated apart from the package's own loop and elements.

Each family gives the force of a specimen [N per unit of k x_y] for a path in units of its yield displacement
x_y; none is built from the elements with which `reliab` learns a specimen. The loop is integrated by central
differences at the sampling rate, the exact response by the same loop with a perfect actuator.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_STATES = 10


def _bouc_wen(x: float, moved: float, rate: float, step: float, s: list[float], p: list[float]) -> float:
    """Bouc and Wen; with p[2], p[3] strength and stiffness fall with energy, with p[4] it is pinched."""
    hardening, exponent = p[0], p[1]
    for _ in range(4):
        part, z = 0.25 * moved, s[0]
        strength, stiffness = 1.0 + p[2] * s[1], 1.0 + p[3] * s[1]
        pinch = 1.0
        if p[4] > 0.0:  # Baber and Noori 1986
            slip = p[4] * (1.0 - math.exp(-p[5] * s[1]))
            width = (0.2 + 0.1 * s[1]) * (p[6] + slip)
            sign = 1.0 if moved > 0.0 else -1.0
            pinch = 1.0 - slip * math.exp(
                -((z * sign - 0.15 * strength ** (-1.0 / exponent)) ** 2) / (width**2 + 1e-9)
            )
        bent = 0.5 * strength * (abs(part) * abs(z) ** (exponent - 1.0) * z + part * abs(z) ** exponent)
        s[0] = z + pinch / stiffness * (part - bent)
        s[1] += max(0.0, (1.0 - hardening) * s[0] * part)
    return hardening * x + (1.0 - hardening) * s[0]


def _cubic(x: float, moved: float, rate: float, step: float, s: list[float], p: list[float]) -> float:
    return x * (1.0 + p[0] * x**2)


def _fluid_damper(x: float, moved: float, rate: float, step: float, s: list[float], p: list[float]) -> float:
    """A spring beside a damper whose force grows with the root of the velocity."""
    return 0.5 * x + p[0] * math.copysign(1.0, rate) * abs(rate / 6.28) ** 0.5


def _bilinear(x: float, moved: float, rate: float, step: float, s: list[float], p: list[float]) -> float:
    s[0] = min(max(s[0] + moved, -1.0), 1.0)
    return p[0] * x + (1.0 - p[0]) * s[0]


def _gap(x: float, moved: float, rate: float, step: float, s: list[float], p: list[float]) -> float:
    return 0.3 * x + 0.7 * (max(x - p[0], 0.0) + min(x + p[0], 0.0))


def _lugre(x: float, moved: float, rate: float, step: float, s: list[float], p: list[float]) -> float:
    """A spring beside friction after Canudas de Wit and others (1995), bristles solved implicitly."""
    stiffness = p[0] / 0.02
    for _ in range(8):
        level = p[0] * (1.0 + 0.3 * math.exp(-((rate / 0.314) ** 2))) / stiffness
        s[0] = (s[0] + rate * step / 8.0) / (1.0 + abs(rate) * step / 8.0 / level)
    return 0.6 * x + stiffness * s[0]


def _menegotto_pinto(
    x: float, moved: float, rate: float, step: float, s: list[float], p: list[float]
) -> float:
    """Giuffrè, Menegotto and Pinto (1973), with curvature that falls with the largest excursion."""
    b = p[0]
    way = 1.0 if moved > 0.0 else (-1.0 if moved < 0.0 else s[6])
    if s[6] == 0.0:
        s[3], s[4], s[5], s[6], s[7], s[8] = way, way, 20.0, way, 1.0, 1.0
    elif way != s[6]:
        begin, force = x - moved, s[0]
        s[1], s[2], s[6] = begin, force, way
        s[7], s[8] = max(s[7], begin), max(s[8], -begin)
        s[3] = (force - begin - way * (1.0 - b)) / (b - 1.0)
        s[4] = way * (1.0 - b) + b * s[3]
        reach = abs(way * (s[7] if way > 0.0 else s[8]) - s[3])
        s[5] = 20.0 - 18.5 * reach / (0.15 + reach)
    span = s[3] - s[1]
    along = (x - s[1]) / span if abs(span) > 1e-12 else 0.0
    curvature = max(s[5], 1.2)
    share = b * along + (1.0 - b) * along / (1.0 + abs(along) ** curvature) ** (1.0 / curvature)
    s[0] = s[2] + share * (s[4] - s[2])
    return s[0]


def _peak_oriented(x: float, moved: float, rate: float, step: float, s: list[float], p: list[float]) -> float:
    """Reloading towards the largest excursion, strength falling with energy (after Ibarra and others)."""
    if s[1] == 0.0:
        s[1], s[2], s[3], s[4] = 1.0, 1.0, -1.0, -1.0
    strength = 1.0 - 0.6 * min(s[5] / p[1], 0.9)
    envelope = strength + p[0] * (max(abs(x), 1.0) - 1.0)
    before, force = x - moved, s[0]
    if moved * force < 0.0:
        now = force + moved
    else:
        peak, most = (s[1], s[2]) if moved > 0.0 else (s[3], s[4])
        limit = strength + p[0] * (max(abs(peak), 1.0) - 1.0)
        aim = min(max(most, -limit), limit)
        left = peak - before
        slope = (aim - force) / left if abs(left) > 1e-9 and left * moved > 0.0 else 1.0
        now = force + min(max(slope, 0.0), 1.0) * moved
    now = min(max(now, -envelope), envelope)
    if x > s[1]:
        s[1], s[2] = x, now
    if x < s[3]:
        s[3], s[4] = x, now
    s[5] += max(0.0, 0.5 * (now + force) * moved)
    s[0] = now
    return now


def _brace(x: float, moved: float, rate: float, step: float, s: list[float], p: list[float]) -> float:
    """A brace that yields in tension and buckles, with a buckling load that falls, in compression."""
    limit = 1.0 + 0.03 * max(x - 1.0, 0.0)
    buckling = p[0] / (1.0 + p[1] * s[1]) * max(0.25, 1.0 - 0.125 * max(0.0, -x - 1.0))
    force = s[0] + moved
    if moved > 0.0 and force > 0.0 and x < s[2]:
        force = min(force, max(s[0] + 0.35 * moved, s[0]))
    force = min(force, limit)
    if force < -buckling:
        s[1] += abs(force + buckling)
        force = -buckling
    if force > 0.95 and x > s[2]:
        s[2] = x
    s[0] = force
    return force


def _rubber(x: float, moved: float, rate: float, step: float, s: list[float], p: list[float]) -> float:
    """Rubber that hardens, softens below its largest excursion (Mullins), and relaxes in 80 ms."""
    s[1] = max(s[1], abs(x))
    softened = 0.55 + 0.45 * math.exp(-p[0] * (s[1] - abs(x)))
    s[0] = s[0] * math.exp(-step / 0.08) + 0.3 * moved
    return (0.7 * x + 0.02 * x**3) * softened + s[0]


FAMILIES: dict[str, tuple[Callable[..., float], Callable[[np.random.Generator], list[float]]]] = {
    "linear": (_cubic, lambda _: [0.0]),
    "cubic": (_cubic, lambda draw: [draw.uniform(0.02, 0.1)]),
    "fluid damper": (_fluid_damper, lambda draw: [draw.uniform(0.3, 1.0)]),
    "bilinear": (_bilinear, lambda draw: [draw.uniform(0.02, 0.15)]),
    "gap": (_gap, lambda draw: [draw.uniform(0.6, 2.0)]),
    "LuGre friction": (_lugre, lambda draw: [draw.uniform(0.2, 0.8)]),
    "Bouc-Wen": (_bouc_wen, lambda draw: [draw.uniform(0.03, 0.15), draw.uniform(1.0, 2.5)]),
    "degrading": (_bouc_wen, lambda draw: [draw.uniform(0.05, 0.15), 1.5, draw.uniform(0.01, 0.05)]),
    "Baber-Noori": (
        _bouc_wen,
        lambda draw: [
            draw.uniform(0.05, 0.15),
            1.5,
            draw.uniform(0.0, 0.02),
            draw.uniform(0.0, 0.04),
            draw.uniform(0.5, 0.9),
            draw.uniform(0.05, 0.3),
            draw.uniform(0.1, 0.4),
        ],
    ),
    "Menegotto-Pinto": (_menegotto_pinto, lambda draw: [draw.uniform(0.01, 0.08)]),
    "peak-oriented": (_peak_oriented, lambda draw: [draw.uniform(0.02, 0.08), draw.uniform(20.0, 100.0)]),
    "buckling brace": (_brace, lambda draw: [draw.uniform(0.4, 0.8), draw.uniform(0.05, 0.3)]),
    "rubber": (_rubber, lambda draw: [draw.uniform(0.3, 1.5)]),
}
"""Families of specimens: their force, and how their parameters are drawn."""


@dataclass(frozen=True, kw_only=True)
class Loop:
    """A structure of unit mass with its specimen."""

    frequency: float
    damping_ratio: float
    share: float
    family: str
    parameters: list[float]
    yield_displacement: float

    def run(self, load: Array, step: float, actuator: "Actuator") -> tuple[Array, Array, Array]:
        """Command, displacement of the specimen and its force under a load per unit mass."""
        turns = 2.0 * np.pi * self.frequency
        damping = 2.0 * self.damping_ratio * turns
        stiffness, of_specimen = (1.0 - self.share) * turns**2, self.share * turns**2
        resist, unit = FAMILIES[self.family][0], self.yield_displacement
        parameters = [*self.parameters, *np.zeros(_STATES).tolist()]
        state, lagged, piston = [0.0] * _STATES, 0.0, 0.0
        follows = 1.0 - math.exp(-step / actuator.lag) if actuator.lag > 0.0 else 1.0
        whole = int(actuator.delay / step)
        part = actuator.delay / step - whole
        command, moved, felt = [0.0], [], []
        for i, pushed in enumerate(load.tolist()):
            near = command[i - whole] if i >= whole else 0.0
            far = command[i - whole - 1] if i > whole else 0.0
            lagged += follows * ((1.0 - part) * near + part * far - lagged)
            aim = actuator.gain * lagged
            piston = min(max(piston, aim - actuator.play), aim + actuator.play)
            by = (piston - (moved[-1] if moved else 0.0)) / unit
            moved.append(piston)
            force = of_specimen * unit * resist(piston / unit, by, by / step, step, state, parameters)
            felt.append(force)
            now, before = command[i], command[i - 1] if i > 0 else 0.0
            inertia = (2.0 * now - before) / step**2 + 0.5 * damping * before / step
            command.append(
                (inertia - stiffness * now - force + pushed) / (1.0 / step**2 + 0.5 * damping / step)
            )
        return np.array(command[:-1]), np.array(moved), np.array(felt)


@dataclass(frozen=True, kw_only=True)
class Actuator:
    """Gain [-], delay and lag [s] and play [m] of an actuator."""

    gain: float = 1.0
    delay: float = 0.0
    lag: float = 0.0
    play: float = 0.0


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
    family: str, load: Array, step: float, draw: np.random.Generator, *, decibels: float = 40.0
) -> SimulatedTest:
    """Draw structure, specimen and actuator, run the test under a load, and record it with noise."""
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
        play=float(draw.choice([0.0, 0.0, 0.003])) * loop.yield_displacement,
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
