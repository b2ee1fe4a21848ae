"""The physics of one instant, compiled: delayed command → piston motion → restoring force.

Every function here states an equation of README.md's effect table. `par` is one record of `PARAMETERS`, in
SI units, in which an absent effect has its neutral value (`neutral_parameters`).
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

_NEUTRAL_ZERO = (
    *("omega", "damping_ratio", "mass", "fraction"),
    *("scheme", "controller_step", "newmark_gamma"),
    *("gain", "delay", "delay_rate", "delay_per_m", "gain_per_m", "gain_rate"),
    *("lag", "servo_omega", "servo_damping", "play"),
    *("force_bias", "stiffness", "damping", "inertia"),
    *("cubic", "quadratic", "coulomb", "quadratic_damping"),
    *("hysteresis_force", "gap", "slip_ratio", "degradation_rate"),
    *("one_sided_stiffness", "one_sided_start", "damping_per_m2", "one_way_damping"),
    *("branch_stiffness", "power_coefficient"),
    *("disturbance_force", "disturbance_omega", "disturbance_phase"),
)
_NEUTRAL_ONE = (
    *(
        "envelope_time",
        "coulomb_velocity",
        "hysteresis_displacement",
        "hysteresis_beta",
        "hysteresis_exponent",
    ),
    *("branch_time", "power_exponent"),
)
_NEUTRAL_INFINITE = ("velocity_limit", "stroke")

PARAMETERS = np.dtype([(name, np.float64) for name in (*_NEUTRAL_ZERO, *_NEUTRAL_ONE, *_NEUTRAL_INFINITE)])
"""One record holds everything that the compiled equations know of a test."""

# Places in the state vector: structure, lag, servo, hysteresis, command envelope, viscoelastic branch.
POSITION, VELOCITY, LAG, SERVO, SERVO_VELOCITY, HYSTERESIS, ENVELOPE, BRANCH = range(8)
STATES = 8
# Places in the memory that a finished step commits: rate limiter, backlash, largest displacement so far.
LIMITED, PLAYED, PEAK = range(3)
MEMORIES = 3


def neutral_parameters() -> NDArray[np.void]:
    """Return a one-record array in which no effect acts."""
    parameters = np.zeros(1, PARAMETERS)
    for name in _NEUTRAL_ONE:
        parameters[name] = 1.0
    for name in _NEUTRAL_INFINITE:
        parameters[name] = np.inf
    return parameters


@njit(error_model="numpy", inline="always")
def look_up(place, known, past, step):
    """Return a past command and two derivatives at `place` steps: cubic Hermite, linear in acceleration."""
    if place < 0.0:
        return past[0, 0], 0.0, 0.0
    node = min(int(place), known - 1)
    r = place - node
    x0, v0, x1, v1 = past[node, 0], past[node, 1] * step, past[node + 1, 0], past[node + 1, 1] * step
    slope = x1 - x0
    curve = 3.0 * slope - 2.0 * v0 - v1
    twist = v0 + v1 - 2.0 * slope
    value = x0 + r * (v0 + r * (curve + r * twist))
    rate = (v0 + r * (2.0 * curve + 3.0 * r * twist)) / step
    return value, rate, past[node, 2] + r * (past[node + 1, 2] - past[node, 2])


@njit(error_model="numpy", inline="always")
def varying_gain(par, t, u, v, a, direct):
    """Return the amplified command: gain·(1 + drift·t), then the position-dependent gain 1 + s·u."""
    factor = par.gain * (1.0 + par.gain_rate * t)
    drift = par.gain * par.gain_rate
    a = factor * a + 2.0 * drift * v
    v = factor * v + drift * u
    u *= factor
    bend = 1.0 + 2.0 * par.gain_per_m * u
    a = bend * a + 2.0 * par.gain_per_m * v * v
    return u * (1.0 + par.gain_per_m * u), bend * v, a, direct * factor * bend


@njit(error_model="numpy", inline="always")
def servo(par, y, rates, stage, u, v, a, direct):
    """Return the motion behind a first-order lag T·ż + z = u and a second-order servo (ω, ζ)."""
    if par.lag > 0.0:
        rates[stage, LAG] = (u - y[LAG]) / par.lag
        u, v, a, direct = y[LAG], rates[stage, LAG], (v - rates[stage, LAG]) / par.lag, 0.0
    if par.servo_omega > 0.0:
        omega = par.servo_omega
        rates[stage, SERVO] = y[SERVO_VELOCITY]
        rates[stage, SERVO_VELOCITY] = omega * (
            omega * (u - y[SERVO]) - 2.0 * par.servo_damping * y[SERVO_VELOCITY]
        )
        u, v, a, direct = y[SERVO], y[SERVO_VELOCITY], rates[stage, SERVO_VELOCITY], 0.0
    return u, v, a, direct


@njit(error_model="numpy", inline="always")
def limits(par, memory, elapsed, u, v, a, direct):
    """Return the motion behind rate limit, backlash and stroke, and what the first two will remember."""
    if par.velocity_limit < math.inf:
        reach = par.velocity_limit * elapsed
        wanted = u - memory[LIMITED]
        if abs(wanted) > reach + 1e-15:
            u = memory[LIMITED] + math.copysign(reach, wanted)
            v, a, direct = math.copysign(par.velocity_limit, wanted), 0.0, 0.0
    limited = u
    if par.play > 0.0:
        low, high = u - 0.5 * par.play, u + 0.5 * par.play
        held = memory[PLAYED]
        carried = (held <= low and v > 0.0) or (held >= high and v < 0.0)
        u = min(max(held, low), high)
        if not carried:
            v, a, direct = 0.0, 0.0, 0.0
    played = u
    if abs(u) >= par.stroke:
        u, v, a, direct = math.copysign(par.stroke, u), 0.0, 0.0, 0.0
    return u, v, a, direct, limited, played


@njit(error_model="numpy")
def elastic_force(par, t, p, peak):
    """Return the springs' force: a degrading linear one behind a dead zone, polynomial and one-sided ones."""
    free = par.gap + par.slip_ratio * max(peak, abs(p))
    stretch = p
    if free > 0.0:
        stretch = math.copysign(max(abs(p) - free, 0.0), p)
    stiffness = par.stiffness * max(1.0 - par.degradation_rate * t, 0.0)
    beyond = max(p - par.one_sided_start, 0.0)
    return stiffness * stretch + (par.cubic * p + par.quadratic) * p * p + par.one_sided_stiffness * beyond


@njit(error_model="numpy")
def dissipative_force(par, p, v):
    """Return the force that opposes velocity: viscous in four forms, quadratic, power law, Coulomb."""
    coefficient = par.damping + par.quadratic_damping * abs(v) + par.damping_per_m2 * p * p
    if v > 0.0:
        coefficient += par.one_way_damping
    force = coefficient * v
    if par.power_coefficient != 0.0:
        force += math.copysign(par.power_coefficient * abs(v) ** par.power_exponent, v)
    if par.coulomb != 0.0:
        force += par.coulomb * math.tanh(v / par.coulomb_velocity)
    return force


@njit(error_model="numpy")
def hysteresis_rate(par, v, z):
    """Return ż = (v/d)·(1 − |z|ⁿ·(β·sgn(vz) + 1 − β)), Bouc–Wen with |z| ≤ 1."""
    turn = par.hysteresis_beta if v * z > 0.0 else -par.hysteresis_beta
    shape = abs(z) ** par.hysteresis_exponent * (turn + 1.0 - par.hysteresis_beta)
    return v / par.hysteresis_displacement * (1.0 - shape)


@njit(error_model="numpy")
def restoring_force(par, t, p, v, z, q, peak):
    """Return the specimen's force without inertia; `z` is hysteresis, `q` the branch's dashpot."""
    force = elastic_force(par, t, p, peak) + dissipative_force(par, p, v) + par.hysteresis_force * z
    force += par.branch_stiffness * (p - q)
    if par.disturbance_force != 0.0:
        force += par.disturbance_force * math.sin(par.disturbance_omega * t + par.disturbance_phase)
    return force
