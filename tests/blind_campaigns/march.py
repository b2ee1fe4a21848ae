"""Fourth-order Runge–Kutta march of the closed loop, and the replay of a specimen by itself."""

import numpy as np
from numba import njit

from blind_campaigns.equations import (
    BRANCH,
    ENVELOPE,
    HYSTERESIS,
    LIMITED,
    MEMORIES,
    PEAK,
    PLAYED,
    POSITION,
    STATES,
    VELOCITY,
    hysteresis_rate,
    limits,
    look_up,
    restoring_force,
    servo,
    varying_gain,
)

EXACT, FORWARD_EULER, EXPLICIT_NEWMARK = range(3)
COMMAND, PISTON, PISTON_VELOCITY, PISTON_ACCELERATION, FORCE = range(5)
CHANNELS = 5
_DIVERGED = 1e3


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


@njit(error_model="numpy", _nrt=False)
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


@njit(error_model="numpy")
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
