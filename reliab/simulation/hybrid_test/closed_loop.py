"""The whole hybrid test, step by step: numerical substructure, compensator, actuator, specimen, load cell.

At each step the integrator moves the structure with the force at the end of the step as far as it is known,
the piston follows, the specimen answers, and the integrator corrects. With a delay of a step or more no
correction is needed.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array, read_only
from reliab.core.compiled import compiled
from reliab.effects.effect import RecordEffect, Role, Setting
from reliab.effects.integration_error import IntegrationError
from reliab.effects.kernel import Kernel, call_kernel, pointer_to
from reliab.signals.cubic_path import CubicPath
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import (
    STATES,
    Motion3,
    Plan,
    call_all,
    plan,
    read_delayed,
    read_displacement,
)
from reliab.simulation.integrators import CoarseExplicit, ExactIntegrator, Integrator


class Compensator(ABC):
    """A delay compensator: it changes the command before it is sent to the actuator.

    A subclass is a frozen dataclass; `studies/laboratory/compensators/` holds those of the studies.
    """

    name: ClassVar[str]  # Unique name, as files call it
    # Called once a step with the motion of the command (displacement, velocity, acceleration), which it
    # changes, and the last measured displacement [m]; arguments: motion, measured, step, coefficients, state
    kernel: ClassVar[Kernel]

    @abstractmethod
    def coefficients(self, step: float) -> Array:
        """Return what the kernel reads, for a step [s]."""


DIVERGENCE_LIMIT = 1e100
"""Command [m] beyond which a loop counts as diverged."""


@compiled
def march(  # noqa: C901, PLR0912, PLR0915 - one compiled loop; what it calls costs more than it is worth
    ground: Array,
    h: float,
    mass: float,
    scheme: tuple[int, int],
    scheme_coefficients: Array,
    socket: Plan,
    actuator: tuple[float, float],
    delays: Plan,
    elements: Plan,
    linear: Array,
    forces: Plan,
    readings: Plan,
    width: int,
) -> tuple[Array, Array, Array]:
    """Step through a whole test from rest.

    `ground` [m/s²]; `h` [s]; `mass` [kg].
    Returns `command, piston`: displacement [m], velocity and acceleration, shape (3, n); NaN after the loop
    has diverged.
    """
    n = ground.size
    integrate, corrections = scheme
    gain, delay = actuator
    command, sent = np.zeros((3, n)), np.zeros((3, n))
    piston, force = np.zeros((3, n)), np.zeros(n)
    # Rows of the states: socket, delays, elements, forces, readings.
    delay_offset = socket.addresses.size
    element_offset = delay_offset + delays.addresses.size
    force_offset = element_offset + elements.addresses.size
    reading_offset = force_offset + forces.addresses.size
    state_size = reading_offset + readings.addresses.size
    states = np.zeros((state_size + 1, width))
    saved_states = np.zeros_like(states)
    motion, scratch = np.zeros(3), np.zeros(width)
    # After a step or more the command at its end has not reached the piston: no correction is needed.
    final = delay >= h and element_offset == 0
    for i in range(n):
        if not final:
            for row in range(state_size):
                for column in range(width):
                    saved_states[row, column] = states[row, column]
        measured_force = 2.0 * force[i - 1] - force[i - 2] if i > 1 else force[0]
        for correction in range(corrections + 1):
            if i > 0:
                early = -(ground[i - 1] + force[i - 1] / mass)
                late = -(ground[i] + measured_force / mass)
                motion[0], motion[1], motion[2] = command[0, i - 1], command[1, i - 1], command[2, i - 1]
                call_kernel(
                    integrate,
                    pointer_to(motion, 0),
                    early,
                    late,
                    pointer_to(scheme_coefficients, 0),
                    pointer_to(scratch, 0),
                )
            else:
                motion[:] = 0.0
            command[0, i], command[1, i], command[2, i] = motion[0], motion[1], motion[2]
            if correction > 0 and final:
                sent[0, i], sent[1, i], sent[2, i] = motion[0], motion[1] * h, motion[2] * h * h
                break
            if correction > 0:
                for row in range(state_size):
                    for column in range(width):
                        states[row, column] = saved_states[row, column]
            last_measured = piston[0, i - 1] if i > 0 else 0.0
            call_all(socket.addresses, socket.coefficients, states, 0, motion, last_measured, h)
            sent[0, i], sent[1, i], sent[2, i] = motion[0], motion[1] * h, motion[2] * h * h
            time = i * h
            tau = delay + call_all(
                delays.addresses, delays.coefficients, states, delay_offset, motion, time, h
            )
            read_delayed(sent, i - max(tau, 0.0) / h, max(i - 1, 0), motion)
            motion[0] *= gain
            motion[1] *= gain / h
            motion[2] *= gain / (h * h)
            call_all(elements.addresses, elements.coefficients, states, element_offset, motion, time, h)
            piston[0, i], piston[1, i], piston[2, i] = motion[0], motion[1], motion[2]
            acting = linear[0] * motion[0] + linear[1] * motion[1] + linear[2] * motion[2]
            acting += call_all(forces.addresses, forces.coefficients, states, force_offset, motion, time, h)
            acting += call_all(
                readings.addresses, readings.coefficients, states, reading_offset, motion, time, h
            )
            has_settled = correction > 0 and tau >= h
            measured_force = acting
            if has_settled or i == 0:
                break
        force[i] = measured_force
        if not abs(command[0, i]) < DIVERGENCE_LIMIT:
            command[:, i:] = np.nan
            piston[:, i:] = np.nan
            force[i:] = np.nan
            break
    return command, piston, force


@dataclass(frozen=True, kw_only=True)
class LoopHistories:
    """What happened in a simulated test, at equal steps."""

    command: Motion3  # Motion of the numerical substructure, which is the command
    piston: Motion3  # True motion of the piston
    measured: Array  # Displacement as the sensor reads it [m], shape (n,)
    force: Array  # Force as the load cell reads it [N], shape (n,)


def run_closed_loop(
    test: HybridTest,
    ground: Array,
    step: float,
    *,
    parts: int = 1,
    integrator: Integrator | None = None,
    compensator: Compensator | None = None,
) -> LoopHistories:
    """Run a hybrid test under a ground motion, from rest.

    `ground` [m/s²]; `step` [s].
    Returns motions, reading and force at the samples. Where the loop diverges, the remaining samples are NaN.

    >>> from reliab.structures.structure import Structure
    >>> test = HybridTest(structure=Structure(frequency=1.0, damping_ratio=0.05))
    >>> shaken = np.sin(2.0 * np.pi * np.arange(0.0, 20.0, 0.005))
    >>> histories = run_closed_loop(test, shaken, 0.005)
    >>> round(float(np.abs(histories.measured[-400:]).max() * test.specimen.stiffness), 2)  # nearly 1/(2ξ)
    9.98
    """
    run = _run(test, ground, step, parts, integrator, compensator)
    piston = Motion3(values=run.at_samples(run.piston), step=step)
    return LoopHistories(
        command=Motion3(values=run.at_samples(run.command), step=step),
        piston=piston,
        measured=read_displacement(test, piston),
        force=run.at_samples(run.force),
    )


def move_piston(test: HybridTest, ground: Array, step: float) -> Motion3:
    """Motion of the piston in :func:`run_closed_loop`, at the samples."""
    run = _run(test, ground, step, 1, None, None)
    return Motion3(values=run.at_samples(run.piston), step=step)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Run:
    """Histories at the steps of the loop."""

    command: Array  # command, piston: Displacement [m], velocity and acceleration, shape (3, n)
    piston: Array
    force: Array  # As the load cell reads it [N], shape (n,)
    parts: int  # Steps of the loop to a sample
    # Instants of the steps, and of the samples, where a controller's steps are no part of them [s]
    instants: tuple[Array, Array] | None = None

    def at_samples(self, values: Array) -> Array:
        """Read histories, shape (…, n), at the samples; the motion is smooth between the loop's steps."""
        if self.instants is None:
            return np.ascontiguousarray(values[..., :: self.parts])
        steps, samples = self.instants
        if not np.isfinite(self.force).all():
            return np.full((*values.shape[:-1], samples.size), np.nan)
        rows = [CubicPath.interpolate(steps, row)(samples) for row in np.atleast_2d(values)]
        return np.reshape(rows, (*values.shape[:-1], samples.size))


def _run(
    test: HybridTest,
    ground: Array,
    step: float,
    parts: int,
    integrator: Integrator | None,
    compensator: Compensator | None,
) -> _Run:
    ground_input = ground
    for effect in test.acting(Role.RECORD):
        if isinstance(effect, RecordEffect):
            ground_input = effect.applied(ground_input, step)
    for effect in test.acting(Role.INTEGRATION):
        if isinstance(effect, IntegrationError) and integrator is None:
            return _run_coarsely(test, effect, ground_input, step, step / parts, compensator)
    if parts > 1:
        fine = np.arange((ground.size - 1) * parts + 1) / parts
        ground_input = np.interp(fine, np.arange(ground.size), ground_input)
    command, piston, force = _march(
        test, ground_input, step / parts, integrator or ExactIntegrator(), compensator
    )
    return _Run(command=command, piston=piston, force=force, parts=parts)


def _run_coarsely(
    test: HybridTest,
    effect: IntegrationError,
    ground: Array,
    step: float,
    longest: float,
    compensator: Compensator | None,
) -> _Run:
    """Run with a controller's own step, a multiple of the loop's."""
    if test.structure is None:
        raise AssertionError  # a closed loop has one
    coarse = max(effect.step_s, longest)
    steps = int(np.ceil(coarse / longest - 1e-9))
    gamma = 0.5 + effect.shift(test.structure.circular_frequency) / coarse
    integrator = CoarseExplicit(gamma=gamma, steps=steps, straight=effect.moves_straight)
    h = coarse / steps
    samples = step * np.arange(ground.size, dtype=np.float64)
    instants = h * np.arange(int(np.ceil(samples[-1] / h)) + 1, dtype=np.float64)
    command, piston, force = _march(test, np.interp(instants, samples, ground), h, integrator, compensator)
    return _Run(command=command, piston=piston, force=force, parts=1, instants=(instants, samples))


def _march(
    test: HybridTest, ground: Array, h: float, integrator: Integrator, compensator: Compensator | None
) -> tuple[Array, Array, Array]:
    specimen = test.specimen
    if specimen is None:
        raise AssertionError  # a structure always brings one
    setting = test.setting(h)
    return march(
        read_only(ground),
        h,
        test.mass,
        (integrator.kernel.address, integrator.corrections),
        integrator.coefficients(test.substructure, h),
        _socket(compensator, h),
        (test.actuator.gain, test.actuator.delay),
        plan(test.acting(Role.DELAY), setting),
        plan(test.acting(Role.PISTON), setting),
        np.array([specimen.stiffness, specimen.damping, specimen.mass]),
        plan(test.acting(Role.FORCE), setting),
        plan(test.acting(Role.FORCE_READING), setting),
        STATES if compensator is None else max(STATES, compensator.kernel.states),
    )


def _socket(compensator: Compensator | None, step: float) -> Plan:
    if compensator is None:
        return plan((), Setting(step=step))
    return Plan(
        np.array([compensator.kernel.address], dtype=np.int64), compensator.coefficients(step)[np.newaxis]
    )
