"""The steps of a whole hybrid test, compiled: command, actuator, specimen and load cell at each instant."""

import numpy as np

from reliab.arrays import Array
from reliab.compiled import compiled
from reliab.effects import call_kernel, pointer_to
from reliab.simulation.hybrid_test.stepping import Plan, call_all, read_delayed

BEYOND_ALL = 1e100
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
    at_delays = socket.addresses.size
    at_elements = at_delays + delays.addresses.size
    at_forces = at_elements + elements.addresses.size
    at_readings = at_forces + forces.addresses.size
    at_end = at_readings + readings.addresses.size
    states = np.zeros((at_end + 1, width))
    saved_states = np.zeros_like(states)
    motion, scratch = np.zeros(3), np.zeros(width)
    # After a step or more the command at its end has not reached the piston: no correction is needed.
    final = delay >= h and at_elements == 0
    for i in range(n):
        if not final:
            for row in range(at_end):
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
                for row in range(at_end):
                    for column in range(width):
                        states[row, column] = saved_states[row, column]
            last_measured = piston[0, i - 1] if i > 0 else 0.0
            call_all(socket.addresses, socket.coefficients, states, 0, motion, last_measured, h)
            sent[0, i], sent[1, i], sent[2, i] = motion[0], motion[1] * h, motion[2] * h * h
            time = i * h
            tau = delay + call_all(delays.addresses, delays.coefficients, states, at_delays, motion, time, h)
            read_delayed(sent, i - max(tau, 0.0) / h, max(i - 1, 0), motion)
            motion[0] *= gain
            motion[1] *= gain / h
            motion[2] *= gain / (h * h)
            call_all(elements.addresses, elements.coefficients, states, at_elements, motion, time, h)
            piston[0, i], piston[1, i], piston[2, i] = motion[0], motion[1], motion[2]
            acting = linear[0] * motion[0] + linear[1] * motion[1] + linear[2] * motion[2]
            acting += call_all(forces.addresses, forces.coefficients, states, at_forces, motion, time, h)
            acting += call_all(
                readings.addresses, readings.coefficients, states, at_readings, motion, time, h
            )
            settled = correction > 0 and tau >= h
            measured_force = acting
            if settled or i == 0:
                break
        force[i] = measured_force
        if not abs(command[0, i]) < BEYOND_ALL:
            command[:, i:] = np.nan
            piston[:, i:] = np.nan
            force[i:] = np.nan
            break
    return command, piston, force
