"""Machines that are not made of the effects of the library: laws of textbooks, each in its own loop.

Each machine draws its parameters from a seed and answers a list of motions, sampled finely, one after the
other; what a machine remembers goes on from test to test. Displacements in metres, forces in newtons.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numba
import numpy as np

from reliab.core.arrays import Array

STEP = 0.0005
"""Step of the simulation [s]."""

Answers = list[Array]
Random = np.random.Generator


@dataclass(frozen=True, kw_only=True)
class Machine:
    """A machine, and what an expert would call it, fixed before any run."""

    answer: Callable[[Random, Sequence[Array]], tuple[Answers, Mapping[str, float]]]
    """Motions → answers, and nominal values of the specimen; empty for an actuator."""
    dominant: tuple[frozenset[str], ...]
    """Groups of names; one of each group must be named, unless the remainder is rightly called unknown."""
    accepted: frozenset[str] = frozenset()
    """Names that may stand beside."""
    unknown: bool = False
    """Whether no member of the library can say it wholly, so that `unknown_effect` is right by itself."""
    actuator: bool = False


# ----------------------------------------------------------------------------------------------- specimens


@numba.njit(cache=False)
def _menegotto_pinto(x: Array, stiffness: float, yielding: float, hardening: float, r0: float) -> Array:
    """Menegotto and Pinto (1973) as in Filippou, Popov and Bertero (1983), without isotropic hardening."""
    forces = np.zeros(x.size)
    x_yield = yielding / stiffness
    x_reversal, f_reversal, x0, f0 = 0.0, 0.0, x_yield, yielding
    x_min, x_max, direction, r = -x_yield, x_yield, 0, r0
    for k in range(1, x.size):
        change = x[k] - x[k - 1]
        new = 1 if change > 0.0 else (-1 if change < 0.0 else direction)
        if new != direction:
            if direction != 0:
                x_reversal, f_reversal = x[k - 1], forces[k - 1]
            x_min, x_max = min(x_min, x[k - 1]), max(x_max, x[k - 1])
            direction = new
            x0 = (new * yielding * (1.0 - hardening) - f_reversal + stiffness * x_reversal) / (
                stiffness * (1.0 - hardening)
            )
            f0 = new * yielding * (1.0 - hardening) + hardening * stiffness * x0
            excursion = abs((x_max if new > 0 else x_min) - x0) / x_yield
            r = r0 - 18.5 * excursion / (0.15 + excursion) if direction != 0 else r0
        ratio = (x[k] - x_reversal) / (x0 - x_reversal) if x0 != x_reversal else 0.0
        shape = hardening * ratio + (1.0 - hardening) * ratio / (1.0 + abs(ratio) ** r) ** (1.0 / r)
        forces[k] = f_reversal + shape * (f0 - f_reversal)
    return forces


def steel_brace(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model a yielding steel brace whose gusset plates bend elastically beside it."""
    peak = max(float(np.abs(x).max()) for x in motions)
    stiffness, x_yield = random.uniform(2e5, 6e5), peak / random.uniform(3.0, 7.0)
    plates = random.uniform(0.02, 0.08) * stiffness
    b, r0 = random.uniform(0.01, 0.03), random.uniform(19.5, 20.5)
    forces = [_menegotto_pinto(x, stiffness, stiffness * x_yield, b, r0) + plates * x for x in motions]
    return forces, {"stiffness_n_per_m": stiffness + plates}


@numba.njit(cache=False)
def _softening_spring(
    x: Array, k1: float, k3: float, r: float, m: float, branch: float, time: float, largest: float
):
    """Ogden and Roxburgh (1999): the force of a virgin spring, less where the energy was once larger."""
    forces, q = np.zeros(x.size), x[0]
    for k in range(x.size):
        energy = 0.5 * k1 * x[k] ** 2 + 0.25 * k3 * x[k] ** 4
        largest = max(largest, energy)
        softer = 1.0 - math.erf((largest - energy) / m) / r
        q += STEP * (x[k] - q) / time
        forces[k] = softer * (k1 * x[k] + k3 * x[k] ** 3) + branch * (x[k] - q)
    return forces, largest


def rubber_bearing(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model a rubber bearing that hardens, softens once it was moved (Mullins), and relaxes."""
    peak = max(float(np.abs(x).max()) for x in motions)
    k1 = random.uniform(5e4, 2e5)
    k3 = k1 * random.uniform(0.2, 0.6) / peak**2
    energy = 0.5 * k1 * peak**2
    r, m = random.uniform(1.5, 3.0), random.uniform(0.2, 0.6) * energy
    branch, time = random.uniform(0.1, 0.3) * k1, random.uniform(0.02, 0.1)
    forces, largest = [], 0.0
    for x in motions:
        force, largest = _softening_spring(x, k1, k3, r, m, branch, time, largest)
        forces.append(force)
    return forces, {"stiffness_n_per_m": k1}


@numba.njit(cache=False)
def _slider_behind_play(x: Array, width: float, stiffness: float, slip: float) -> Array:
    """Pin with clearance, then an elastic brace, then a sliding joint."""
    forces, pin, slid = np.zeros(x.size), x[0], x[0]
    for k in range(x.size):
        pin = min(max(pin, x[k] - 0.5 * width), x[k] + 0.5 * width)
        force = stiffness * (pin - slid)
        if abs(force) > slip:
            force = math.copysign(slip, force)
            slid = pin - force / stiffness
        forces[k] = force
    return forces


def friction_damper_with_play(
    random: Random, motions: Sequence[Array]
) -> tuple[Answers, Mapping[str, float]]:
    """Model a friction damper on an elastic brace whose pins have clearance."""
    peak = max(float(np.abs(x).max()) for x in motions)
    slip, width = random.uniform(2e3, 1e4), random.uniform(0.03, 0.12) * peak
    stiffness = slip / (random.uniform(0.03, 0.15) * peak)
    return [_slider_behind_play(x, width, stiffness, slip) for x in motions], {"stiffness_n_per_m": 0.0}


@numba.njit(cache=False)
def _oil(x: Array, stiffness: float, coefficient: float, power: float) -> Array:
    """Compressible oil before an orifice: F' = k (v − (F/c)^(1/p))."""
    forces, force = np.zeros(x.size), 0.0
    for k in range(1, x.size):
        v = (x[k] - x[k - 1]) / STEP
        for _ in range(20):
            flow = math.copysign((abs(force) / coefficient) ** (1.0 / power), force)
            force += 0.05 * STEP * stiffness * (v - flow)
        forces[k] = force
    return forces


def oil_damper(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model a fluid damper beside a spring: a power law of the velocity, with compressible oil."""
    speed = max(float(np.abs(np.gradient(x, STEP)).max()) for x in motions)
    peak = max(float(np.abs(x).max()) for x in motions)
    spring, power = random.uniform(3e4, 1e5), random.uniform(0.3, 0.6)
    force = random.uniform(0.3, 0.8) * spring * peak
    coefficient = force / speed**power
    oil = force / (random.uniform(0.002, 0.008) * peak)
    forces = [spring * x + _oil(x, oil, coefficient, power) for x in motions]
    return forces, {"stiffness_n_per_m": spring}


@numba.njit(cache=False)
def _lugre(x: Array, s0: float, s1: float, coulomb: float, static: float, stribeck: float) -> Array:
    """Model friction by bristles: Canudas de Wit and others (1995)."""
    forces, z = np.zeros(x.size), 0.0
    for k in range(1, x.size):
        v = (x[k] - x[k - 1]) / STEP
        level = (coulomb + (static - coulomb) * math.exp(-((v / stribeck) ** 2))) / s0
        begin = z
        z = level * math.copysign(1.0, v) + (z - level * math.copysign(1.0, v)) * math.exp(
            -abs(v) * STEP / level
        )
        forces[k] = s0 * z + s1 * (z - begin) / STEP
    return forces


def pendulum_bearing(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model a curved sliding bearing: restoring force of a pendulum and friction of bristles (LuGre)."""
    peak = max(float(np.abs(x).max()) for x in motions)
    speed = max(float(np.abs(np.gradient(x, STEP)).max()) for x in motions)
    restoring = random.uniform(2e4, 8e4)
    coulomb = random.uniform(0.15, 0.5) * restoring * peak
    s0 = coulomb / (random.uniform(0.002, 0.01) * peak)
    static = random.uniform(1.0, 1.15) * coulomb
    forces = [
        restoring * x + _lugre(x, s0, 1e-4 * s0, coulomb, static, random.uniform(0.02, 0.1) * speed)
        for x in motions
    ]
    return forces, {"stiffness_n_per_m": restoring}


def bumpers(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model a spring that is joined by Hertzian bumpers on both sides beyond a clearance."""
    peak = max(float(np.abs(x).max()) for x in motions)
    spring, clear = random.uniform(3e4, 1e5), random.uniform(0.2, 0.5) * peak
    hertz = random.uniform(0.5, 2.0) * spring * peak / (peak - clear) ** 1.5
    forces = [spring * x + np.sign(x) * hertz * np.maximum(np.abs(x) - clear, 0.0) ** 1.5 for x in motions]
    return forces, {"stiffness_n_per_m": spring}


@numba.njit(cache=False)
def _two_sliders(x: Array, strengths: Array, stiffnesses: Array, forward: float) -> Array:
    """Sum of elastic sliders in parallel (Iwan 1966), stronger forwards than backwards."""
    forces, slid = np.zeros(x.size), np.full(strengths.size, x[0])
    for k in range(x.size):
        for j in range(strengths.size):
            force = stiffnesses[j] * (x[k] - slid[j])
            strength = strengths[j] * (forward if force > 0.0 else 2.0 - forward)
            if abs(force) > strength:
                force = math.copysign(strength, force)
                slid[j] = x[k] - force / stiffnesses[j]
            forces[k] += force
    return forces


def wire_rope(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model a wire-rope isolator: thirty sliders that slip one after the other, beside a spring."""
    peak = max(float(np.abs(x).max()) for x in motions)
    spring = random.uniform(3e4, 1e5)
    onset = peak * np.linspace(0.01, random.uniform(0.2, 0.6), 30)
    stiffnesses = np.full(30, random.uniform(0.5, 1.5) * spring / 30.0)
    forward = random.uniform(1.0, 1.05)
    forces = [spring * x + _two_sliders(x, stiffnesses * onset, stiffnesses, forward) for x in motions]
    return forces, {"stiffness_n_per_m": spring + float(stiffnesses.sum())}


@numba.njit(cache=False)
def _bouc_wen(x: Array, yields: float, beta: float, n: float) -> Array:
    """Wen (1976) over the yield force, by a quarter of a step of Euler's method."""
    z = np.zeros(x.size)
    for k in range(1, x.size):
        now, part = z[k - 1], 0.25 * (x[k] - x[k - 1]) / yields
        for _ in range(4):
            now += part - beta * abs(part) * abs(now) ** (n - 1.0) * now - (1.0 - beta) * part * abs(now) ** n
        z[k] = now
    return z


def magnetic_damper(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model a magneto-rheological damper: Bouc–Wen beside a fluid whose force is a power of the velocity."""
    peak = max(float(np.abs(x).max()) for x in motions)
    speed = max(float(np.abs(np.gradient(x, STEP)).max()) for x in motions)
    force, yields = random.uniform(5e2, 2e3), random.uniform(0.02, 0.1) * peak
    spring, beta = random.uniform(0.0, 0.3) * force / peak, random.uniform(0.5, 0.9)
    n, power = random.uniform(1.2, 2.5), random.uniform(0.35, 1.8)
    fluid = random.uniform(0.4, 1.2) * force
    forces = []
    for x in motions:
        v = np.gradient(x, STEP) / speed
        flow = np.sign(v) * np.abs(v) ** power
        forces.append(spring * x + force * _bouc_wen(x, yields, beta, n) + fluid * flow)
    return forces, {"stiffness_n_per_m": 0.0}


@numba.njit(cache=False)
def _slider_behind_clearance(
    x: Array, width: float, stiffness: float, forward: float, backward: float
) -> Array:
    """Pin with clearance that carries no force, an elastic brace, a joint that slides in two directions."""
    forces, slid = np.zeros(x.size), x[0]
    for k in range(x.size):
        pin = min(max(slid, x[k] - 0.5 * width), x[k] + 0.5 * width)
        forces[k] = min(max(stiffness * (pin - slid), -backward), forward)
        slid = pin - forces[k] / stiffness
    return forces


def damper_with_clearance(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model a friction damper, unlike in its two directions, whose pins come free when it is unloaded."""
    peak = max(float(np.abs(x).max()) for x in motions)
    slip, width = random.uniform(2e3, 1e4), random.uniform(0.03, 0.12) * peak
    stiffness, unlike = slip / (random.uniform(0.01, 0.08) * peak), random.uniform(-0.2, 0.2)
    sides = (1.0 + unlike) * slip, (1.0 - unlike) * slip
    return [_slider_behind_clearance(x, width, stiffness, *sides) for x in motions], {
        "stiffness_n_per_m": 0.0
    }


# ----------------------------------------------------------------------------------------------- actuators


@numba.njit(cache=False)
def _hydraulic(r: Array, gain: float, flow: float, spring: float, friction: float, valve: float) -> Array:
    """Position loop of a servo valve with orifices, compressible oil, friction; pressure over the supply's.

    `gain` [1/m], `flow` no-load speed at full opening [m/s], `spring` oil over mass [1/s²], `friction` over
    the full force, `valve` [rad/s]; the full force accelerates by 60 m/s²
    and leakage damps the oil's resonance to 0.3.
    """
    x = np.zeros(r.size)
    position, speed, load, opening, rate = r[0], 0.0, 0.0, 0.0, 0.0
    for k in range(r.size):
        for _ in range(4):
            step = 0.25 * STEP
            target = min(max(gain * (r[k] - position), -1.0), 1.0)
            rate += step * (valve**2 * (target - opening) - 1.4 * valve * rate)
            opening += step * rate
            flow_through = opening * math.sqrt(max(1.0 - math.copysign(load, opening), 0.0))
            load += step * (spring / 60.0 * (flow * flow_through - speed) - 0.6 * math.sqrt(spring) * load)
            load = min(max(load, -0.98), 0.98)
            speed += step * 60.0 * (load - friction * math.tanh(speed / (1e-3 * flow)))
            position += step * speed
        x[k] = position
    return x


def _servo(random: Random, motions: Sequence[Array], reserve: float) -> tuple[Answers, Mapping[str, float]]:
    """Hydraulic servo whose no-load speed is a multiple of the largest speed of the command."""
    speed = max(float(np.abs(np.gradient(x, STEP)).max()) for x in motions)
    flow, delay = reserve * speed, random.uniform(0.012, 0.03)
    gain, oil = 1.0 / (delay * flow), (2.0 * np.pi * random.uniform(25.0, 40.0)) ** 2
    friction, valve = random.uniform(0.005, 0.03), 2.0 * np.pi * random.uniform(60.0, 120.0)
    return [_hydraulic(x, gain, flow, oil, friction, valve) for x in motions], {}


def hydraulic_servo(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model a hydraulic servo with flow to spare."""
    return _servo(random, motions, random.uniform(3.0, 6.0))


def servo_without_reserve(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model a hydraulic servo whose valve cannot give the largest speed of the command."""
    return _servo(random, motions, random.uniform(0.55, 0.75))


@numba.njit(cache=False)
def _electric(r: Array, turn: float, ratio: float, largest: float, cogging: float, pitch: float, dry: float):
    """Table on a linear motor: position loop with a current limit, cogging and dry friction [m/s²]."""
    x, position, speed = np.zeros(r.size), r[0], 0.0
    for k in range(r.size):
        target = turn**2 * (r[k] - position) - 2.0 * ratio * turn * speed
        drive = min(max(target, -largest), largest)
        force = drive + cogging * math.sin(2.0 * math.pi * position / pitch) - dry * math.tanh(speed / 1e-3)
        speed += STEP * force
        position += STEP * speed
        x[k] = position
    return x


def _table(random: Random, motions: Sequence[Array], reserve: float) -> tuple[Answers, Mapping[str, float]]:
    """Electric table whose current gives a multiple of the largest acceleration of the command."""
    peak = max(float(np.abs(x).max()) for x in motions)
    turn, ratio = 2.0 * np.pi * random.uniform(8.0, 14.0), random.uniform(0.5, 0.9)
    scale = turn**2 * peak
    cogging, dry = random.uniform(0.001, 0.004) * scale, random.uniform(0.001, 0.004) * scale
    pitch = random.uniform(0.2, 0.5) * peak
    largest = reserve * max(float(np.abs(np.gradient(np.gradient(x, STEP), STEP)).max()) for x in motions)
    return [_electric(x, turn, ratio, largest, cogging, pitch, dry) for x in motions], {}


def electric_table(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model an electric table with current to spare, cogging and a little friction."""
    return _table(random, motions, 10.0)


def table_without_reserve(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model an electric table whose current cannot give the largest acceleration of the command."""
    return _table(random, motions, random.uniform(0.5, 0.7))


@numba.njit(cache=False)
def _screw_play(x: Array, width: float) -> Array:
    displacement, last = np.zeros(x.size), x[0]
    for k in range(x.size):
        last = min(max(last, x[k] - 0.5 * width), x[k] + 0.5 * width)
        displacement[k] = last
    return displacement


def screw_with_play(random: Random, motions: Sequence[Array]) -> tuple[Answers, Mapping[str, float]]:
    """Model a ball screw with a worn nut behind a motor's position loop."""
    peak = max(float(np.abs(x).max()) for x in motions)
    driven, _ = electric_table(random, motions)
    width = random.uniform(0.02, 0.08) * peak
    return [_screw_play(x, width) for x in driven], {}


_LAG = frozenset({"first_order_lag", "second_order_dynamics"})
_YIELDS = frozenset({"hysteresis", "degrading_hysteresis"})
_DRY = frozenset({"coulomb_friction", "hysteresis"})
_OFFSETS = frozenset({"sensor_bias", "force_bias"})
_FLOWS = frozenset({"viscous_damping", "quadratic_damping", "power_law_damping"})

MACHINES: Mapping[str, Machine] = {
    "steel_brace": Machine(answer=steel_brace, dominant=(_YIELDS,)),
    "rubber_bearing": Machine(
        answer=rubber_bearing,
        dominant=(frozenset({"cubic_stiffness", *_YIELDS}),),
        accepted=frozenset({"cubic_stiffness", *_YIELDS}),
        unknown=True,
    ),
    "friction_damper_with_play": Machine(
        answer=friction_damper_with_play,
        dominant=(_DRY, frozenset({"series_play", "gap"})),
        unknown=True,
    ),
    "oil_damper": Machine(
        answer=oil_damper,
        dominant=(frozenset({"power_law_damping", "viscous_damping"}),),
        unknown=True,
    ),
    "pendulum_bearing": Machine(
        answer=pendulum_bearing, dominant=(_DRY,), accepted=frozenset({"viscous_damping"})
    ),
    "bumpers": Machine(answer=bumpers, dominant=(frozenset({"gap", "cubic_stiffness"}),), unknown=True),
    "wire_rope": Machine(answer=wire_rope, dominant=(frozenset({"hysteresis"}),)),
    "magnetic_damper": Machine(answer=magnetic_damper, dominant=(frozenset({"hysteresis"}), _FLOWS)),
    "damper_with_clearance": Machine(
        answer=damper_with_clearance, dominant=(_DRY, frozenset({"series_play", "gap"}))
    ),
    "hydraulic_servo": Machine(
        answer=hydraulic_servo, dominant=(_LAG,), accepted=frozenset({"backlash"}), actuator=True
    ),
    "starved_servo": Machine(
        answer=servo_without_reserve,
        dominant=(frozenset({"rate_limit"}),),
        accepted=_LAG | {"backlash"},
        unknown=True,
        actuator=True,
    ),
    "electric_table": Machine(
        answer=electric_table, dominant=(_LAG,), accepted=frozenset({"backlash"}), actuator=True
    ),
    "limited_table": Machine(
        answer=table_without_reserve,
        dominant=(_LAG,),
        accepted=frozenset({"backlash"}),
        unknown=True,
        actuator=True,
    ),
    "worn_screw": Machine(answer=screw_with_play, dominant=(_LAG, frozenset({"backlash"})), actuator=True),
}
"""Machines by name, with the names that an expert would give; offsets may always stand beside."""

ALWAYS_ACCEPTED = _OFFSETS
