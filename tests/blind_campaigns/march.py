"""A test, compiled: the physics of one instant, its fourth-order Runge–Kutta march, a specimen by itself.

At an instant: delayed command → piston motion → restoring force. Every function up to `restoring_force`
states an equation of README.md's effect table. `par` is one record of `PARAMETERS`, in SI units, in which an
absent effect has its neutral value (`neutral_parameters`). Compiled code is kept for this file as it is: what
a kernel calls stands here too.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

EXACT, FORWARD_EULER, EXPLICIT_NEWMARK = range(3)
COMMAND, PISTON, PISTON_VELOCITY, PISTON_ACCELERATION, FORCE = range(5)
CHANNELS = 5
_DIVERGED = 1e3

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


@njit(error_model="numpy", inline="always")
def _delayed(par, t, y, rates, stage, past, known, prescribed, step):
    """Return u(t − τ), its derivatives, and how much of the present acceleration the second one contains.

    Within the last step (a delay shorter than the step) the past is a Taylor expansion about the present.
    """
    delay = par.delay + par.delay_rate * t
    rate = par.delay_rate
    if par.delay_per_m != 0.0:
        present = look_up(t / step, known, past, step)[0] if prescribed else y[POSITION]
        rates[stage, ENVELOPE] = (abs(present) - y[ENVELOPE]) / par.envelope_time
        delay += par.delay_per_m * y[ENVELOPE]
        rate += par.delay_per_m * rates[stage, ENVELOPE]
    if delay <= 0.0:
        delay, rate = 0.0, 0.0
    warp = 1.0 - rate
    if prescribed or delay >= step:
        u, v, a = look_up(t / step - delay / step, known, past, step)
        return u, v * warp, a * warp * warp, 0.0
    recent = past[known, 2]
    u = y[POSITION] - delay * y[VELOCITY] + 0.5 * delay * delay * recent
    return u, (y[VELOCITY] - delay * recent) * warp, 0.0, warp * warp


@njit(error_model="numpy", inline="always")
def _evaluate(par, t, ground, noise, elapsed, y, rates, stage, past, memory, fresh, known, prescribed, step):
    """Fill dy at one stage; return piston position, velocity, acceleration, force, structure acceleration."""
    u, v, a, direct = _delayed(par, t, y, rates, stage, past, known, prescribed, step)
    u, v, a, direct = varying_gain(par, t, u, v, a, direct)
    u, v, a, direct = servo(par, y, rates, stage, u, v, a, direct)
    u, v, a, direct, fresh[LIMITED], fresh[PLAYED] = limits(par, memory, elapsed, u, v, a, direct)
    fresh[PEAK] = max(memory[PEAK], abs(u))
    if par.hysteresis_force != 0.0:
        rates[stage, HYSTERESIS] = hysteresis_rate(par, v, y[HYSTERESIS])
    if par.branch_stiffness != 0.0:
        rates[stage, BRANCH] = (u - y[BRANCH]) / par.branch_time
    force = restoring_force(par, t, u, v, y[HYSTERESIS], y[BRANCH], fresh[PEAK]) + par.inertia * a
    if prescribed:
        return u, v, a, force, 0.0
    pull = 2.0 * par.damping_ratio * par.omega * y[VELOCITY]
    pull += (1.0 - par.fraction) * par.omega * par.omega * y[POSITION]
    pull += (force + par.force_bias + noise) / par.mass
    acceleration = -(ground + pull) / (1.0 + direct * par.inertia / par.mass)
    return u, v, a + direct * acceleration, force + par.inertia * direct * acceleration, acceleration


@njit(error_model="numpy", inline="always")
def _split(j, share, substeps, count):
    """Return the sample before an instant (`share` of a step after step j) and the part that follows it."""
    sample = min(j // substeps, count - 2)
    return sample, (j - sample * substeps + share) / substeps


@njit(error_model="numpy", inline="always")
def _between(samples, sample, part):
    return samples[sample] + part * (samples[sample + 1] - samples[sample])


@njit(error_model="numpy")
def _controller_step(par, held, rise):
    """Return the change of velocity at the controller's instant, and the acceleration of its next step.

    Forward Euler adds Δ·a₀. Explicit Newmark moved with v + s·a₀ and wants v + Δ·((1 − γ)·a₀ + γ·a₁). In both
    a₁ depends on the changed velocity through the damping.
    """
    damped = 2.0 * par.damping_ratio * par.omega
    if par.scheme == FORWARD_EULER:
        change = par.controller_step * held
        return change, rise - damped * change
    weight = par.newmark_gamma * par.controller_step
    change = weight * (rise - held) / (1.0 + weight * damped)
    return change, rise - damped * change


@njit(error_model="numpy", _nrt=False, cache=True)
def march(parameters, ground, noise, past, prescribed, substeps, step, out, states, rates, memories):  # noqa: C901, PLR0912
    """Fill `out` (CHANNELS, samples) with one test; return whether it stayed bounded.

    `past` holds position, velocity and acceleration of the command at every step: filled here when the loop
    is closed, given when the command is prescribed. `states` (2, STATES), `rates` (4, STATES) and
    `memories` (2, MEMORIES) are zeros to work on: arrays come from outside and the helpers are inlined, so
    that nothing here counts references, which takes three quarters of the time otherwise (`_nrt=False`).
    Ground acceleration and fed-back noise are linear between samples. A controller that integrates with a
    coarse scheme (README.md, `integration_error`) moves the command along the polynomial of its own step.
    """
    par = parameters[0]
    y, trial = states
    memory, fresh = memories
    last = past.shape[0] - 1
    steps = (out.shape[1] - 1) * substeps
    held, due = 0.0, par.controller_step
    for j in range(steps + 1):
        known = last if prescribed else j
        if not prescribed:
            past[j, 0], past[j, 1], past[j, 2] = y[POSITION], y[VELOCITY], past[max(j - 1, 0), 2]
        for stage in range(4):
            # The first stage closes the step before, whose memory counts from that step's beginning.
            share = 0.5 * ((stage + 1) // 2)
            elapsed = share * step if stage > 0 else (step if j > 0 else 0.0)
            for i in range(STATES):
                trial[i] = y[i] + (share * step * rates[stage - 1, i] if stage > 0 else 0.0)
            t = (j + share) * step
            sample, part = _split(j, share, substeps, ground.size)
            p, v, a, force, rise = _evaluate(
                par, t, _between(ground, sample, part), _between(noise, sample, part),
                elapsed, trial, rates, stage, past, memory, fresh, known, prescribed, step,
            )  # fmt: skip
            rates[stage, POSITION], rates[stage, VELOCITY] = trial[VELOCITY], rise
            if stage > 0:
                if par.scheme != EXACT:
                    rates[stage, VELOCITY] = rates[0, VELOCITY]
                continue
            for i in range(MEMORIES):
                memory[i] = fresh[i]
            if par.scheme != EXACT:
                if j == 0:
                    held = rise
                elif t > due - 0.5 * step:
                    due += par.controller_step
                    change, held = _controller_step(par, held, rise)
                    y[VELOCITY] += change
                rates[0, POSITION] = y[VELOCITY]
                rates[0, VELOCITY] = held if par.scheme == EXPLICIT_NEWMARK else 0.0
            if not prescribed:
                past[j, 1], past[j, 2] = y[VELOCITY], rates[0, VELOCITY]
            if j % substeps == 0:
                sample = j // substeps
                out[COMMAND, sample] = past[j, 0]
                out[PISTON, sample], out[PISTON_VELOCITY, sample] = p, v
                out[PISTON_ACCELERATION, sample], out[FORCE, sample] = a, force
                if not abs(past[j, 0]) + abs(p) < _DIVERGED:
                    return False
            if j == steps:
                return True
        for i in range(STATES):
            y[i] += step / 6.0 * (rates[0, i] + 2.0 * rates[1, i] + 2.0 * rates[2, i] + rates[3, i])
    return True


@njit(error_model="numpy", cache=True)
def replay_specimen(parameters, piston, velocity, acceleration, interval):
    """Return the force [N] under a sampled piston motion, inner states by Heun's method in quarter steps."""
    par = parameters[0]
    force = np.empty(piston.size)
    z, q, peak = 0.0, 0.0, 0.0
    part = 0.25 * interval
    for i in range(piston.size):
        peak = max(peak, abs(piston[i]))
        force[i] = restoring_force(par, i * interval, piston[i], velocity[i], z, q, peak)
        force[i] += par.inertia * acceleration[i]
        if i + 1 == piston.size or (par.hysteresis_force == 0.0 and par.branch_stiffness == 0.0):
            continue
        for quarter in range(4):
            r0, r1 = 0.25 * quarter, 0.25 * (quarter + 1)
            v0 = velocity[i] + r0 * (velocity[i + 1] - velocity[i])
            v1 = velocity[i] + r1 * (velocity[i + 1] - velocity[i])
            p0 = piston[i] + r0 * (piston[i + 1] - piston[i])
            p1 = piston[i] + r1 * (piston[i + 1] - piston[i])
            first = hysteresis_rate(par, v0, z)
            z += 0.5 * part * (first + hysteresis_rate(par, v1, z + part * first))
            first = (p0 - q) / par.branch_time
            q += 0.5 * part * (first + (p1 - q - part * first) / par.branch_time)
    return force
