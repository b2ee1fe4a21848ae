"""The order of events in a digital laboratory, compiled.

At t_k the target γᵀx is read from the numerical substructure and the displacement x_m from the sensor; the
controller sends the command u_k, held over the step; the force f(t_k) is read, but the numerical substructure
is advanced with f(t_(k−1)), held over the step, as on a real-time target computer that exchanges samples.
"""

from typing import NamedTuple

import numpy as np

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.effects.kernel import call_kernel, pointer_to
from reliab.simulation.hybrid_test.open_loop import Plan, call_all


class NumericalStep(NamedTuple):
    """One step of the numerical substructure: transition, ground at begin, middle, end, force, and its rows.

    `accelerated` is the row of the interface's acceleration: state, ground acceleration, force.
    """

    transition: Array
    early: Array
    middle: Array
    late: Array
    force: Array
    interface: Array
    accelerated: Array


class PlantStep(NamedTuple):
    """One step of the plant, exact, and what Runge-Kutta stages need where velocities are differences."""

    transition: Array
    command: Array
    nonlinear: Array
    displacement: Array
    velocity: Array
    force: Array
    displacement_of_command: float
    force_of_command: float
    contains_nonlinear: bool
    dynamics: Array
    command_rate: Array
    differenced: Array
    linear: Array
    """Stiffness, damping and mass of the specimen."""


class Events(NamedTuple):
    """Delay in whole steps and a fraction, limits, resolutions, and where a test counts as lost."""

    whole: int
    fraction: float
    stroke: float
    rate: float
    force: float
    command_step: float
    displacement_step: float
    force_step: float
    beyond: float


@compiled
def _round(value: float, step: float) -> float:
    return step * np.rint(value / step) if step > 0.0 else value


@compiled
def march(  # noqa: C901, PLR0912, PLR0915 - one compiled loop; what it calls costs more than it is worth
    ground: Array,
    between: Array,
    h: float,
    numerical: NumericalStep,
    plant: PlantStep,
    events: Events,
    socket: Plan,
    width: int,
    forces: Plan,
    noise: Array,
    emulate: bool,  # noqa: FBT001 - compiled
) -> tuple[Array, Array, int]:
    """Run a test; returns floors (n, samples); command, piston, reading and force reading; samples run."""
    samples, states, order = ground.size, numerical.transition.shape[0], plant.transition.shape[0]
    floors = np.zeros((states // 2, samples))
    signals = np.zeros((4, samples))
    z, z_next = np.zeros(states), np.zeros(states)
    w, w_next, stage = np.zeros(order), np.zeros(order), np.zeros(order)
    slopes = np.zeros((4, order))
    memory = np.zeros((max(socket.addresses.size, 1), width))
    states_of_forces = np.zeros((max(forces.addresses.size, 1), 16))
    motion = np.zeros(3)
    received = 0.0  # force with which the numerical substructure is advanced
    reading_before, arrived, nonlinear, nonlinear_before = 0.0, 0.0, 0.0, 0.0
    x_before, difference_before, sent_before = 0.0, 0.0, 0.0
    for k in range(samples):
        # 1 Target and reading of the displacement.
        for i in range(states // 2):
            floors[i, k] = z[i]
        motion[0], motion[1], motion[2] = 0.0, 0.0, 0.0
        for i in range(states // 2):
            motion[0] += numerical.interface[i] * z[i]
            motion[1] += numerical.interface[i] * z[states // 2 + i]
        for i in range(states):
            motion[2] += numerical.accelerated[i] * z[i]
        motion[2] += numerical.accelerated[states] * ground[k] + numerical.accelerated[states + 1] * received
        x, v = plant.displacement_of_command * arrived, 0.0
        for i in range(order):
            x += plant.displacement[i] * w[i]
            v += plant.velocity[i] * w[i]
        measured = _round(x + noise[0, k], events.displacement_step)
        # 2 Controller and converter.
        if socket.addresses.size > 0:
            call_kernel(
                socket.addresses[0],
                pointer_to(motion, 0),
                measured,
                h,
                pointer_to(socket.coefficients, 0),
                pointer_to(memory, 0),
            )
        sent = min(max(motion[0], -events.stroke), events.stroke)
        sent = min(max(sent, sent_before - h * events.rate), sent_before + h * events.rate)
        sent_before = sent
        signals[0, k] = sent = _round(sent, events.command_step)
        late = signals[0, k - events.whole] if k >= events.whole else 0.0
        later = signals[0, k - events.whole - 1] if k > events.whole else 0.0
        held = events.fraction * later + (1.0 - events.fraction) * late
        # 3 Force of the specimen.
        difference = (x - x_before) / h
        if forces.addresses.size > 0:
            motion[0], motion[1], motion[2] = x, v, 0.0
            nonlinear_before = nonlinear
            nonlinear = call_all(forces.addresses, forces.coefficients, states_of_forces, 0, motion, k * h, h)
        if emulate:
            force = plant.linear[0] * x + plant.linear[1] * difference
            force += plant.linear[2] * (difference - difference_before) / h + nonlinear
        else:
            force = plant.force_of_command * arrived
            for i in range(order):
                force += plant.force[i] * w[i]
            if not plant.contains_nonlinear:
                force += nonlinear
        arrived = held
        reading = _round(force + noise[1, k], events.force_step)
        signals[1, k], signals[2, k], signals[3, k] = x, measured, reading
        if not (abs(x) < events.beyond and abs(motion[0]) < events.beyond):
            return floors, signals, k
        received, reading_before = reading_before, reading
        if k + 1 == samples:
            break
        # 4 Everything advances.
        for i in range(states):
            total = numerical.early[i] * ground[k] + numerical.late[i] * ground[k + 1]
            total += numerical.middle[i] * between[k] + numerical.force[i] * received
            for j in range(states):
                total += numerical.transition[i, j] * z[j]
            z_next[i] = total
        for i in range(states):
            z[i] = z_next[i]
        acting = 1.5 * nonlinear - 0.5 * nonlinear_before  # in the middle of the step
        if emulate:
            for quarter in range(4):
                reach = 0.0 if quarter == 0 else (0.5 * h if quarter < 3 else h)  # noqa: PLR2004
                for i in range(order):
                    stage[i] = w[i] + (reach * slopes[quarter - 1, i] if quarter > 0 else 0.0)
                rate = difference
                if quarter > 0:
                    here = 0.0
                    for i in range(order):
                        here += plant.displacement[i] * stage[i]
                    rate = (here - x) / reach
                for i in range(order):
                    slope = plant.command_rate[i] * held + plant.differenced[i] * rate
                    for j in range(order):
                        slope += plant.dynamics[i, j] * stage[j]
                    slopes[quarter, i] = slope
            for i in range(order):
                w_next[i] = w[i] + h / 6.0 * (
                    slopes[0, i] + 2.0 * slopes[1, i] + 2.0 * slopes[2, i] + slopes[3, i]
                )
        else:
            for i in range(order):
                total = plant.command[i] * held + plant.nonlinear[i] * acting
                for j in range(order):
                    total += plant.transition[i, j] * w[j]
                w_next[i] = total
        for i in range(order):
            w[i] = w_next[i]
        if events.force < np.inf:
            _cut_off(w, plant.force, events.force)
        x_before, difference_before = x, difference
    return floors, signals, samples


@compiled
def _cut_off(w: Array, row: Array, limit: float) -> None:
    """Hold the state that is the force at its limit."""
    for i in range(w.size):
        if row[i] == 1.0:
            w[i] = min(max(w[i], -limit), limit)
