"""Errors of a test if its specimen yielded, on any linear structure beside it.

A specimen that yields has the force Z x − k_e s[x], with s the displacement that its stiffness has lost by
yielding. Subtracting the equations of motion as `rebuild` does leaves ::

    M e'' + C e' + K e = γ (Z (x_c − x_m) + k_e (s[x_m] − s[x_c − e]))

the same recursion with a second input, and no ground motion is needed; a specimen that hardens loses less
than nothing. The response x_c − e at a sample
depends on the input there by (ω₀h)²/6 only, which two corrections take away.
"""

from collections.abc import Sequence

import numpy as np

from reliab.assessment.rebuilt_error.histories import Histories
from reliab.assessment.rebuilt_error.recursion import Recursion, advance
from reliab.core.arrays import Array, read_only
from reliab.core.compiled import compiled
from reliab.effects.effect import Setting, SteppedEffect
from reliab.effects.hysteresis import Hysteresis
from reliab.effects.kernel import call_kernel, pointer_to
from reliab.structures.partition import Partition

_CORRECTIONS = 2


def yielding_specimen(displacement: float, hardening: float, sharpness: float) -> Hysteresis:
    """Give −s [m] of a specimen that yields at a displacement [m], as a force per unit of its stiffness.

    `hardening`: stiffness after yielding over that before; `sharpness`: exponent of the hysteresis.
    """
    return Hysteresis(
        force_n=(1.0 - hardening) * displacement,
        displacement_m=displacement,
        exponent=sharpness,
        lost_share=1.0,
    )


def additional_displacement(specimen: SteppedEffect, motion: Array, time_step: float) -> Array:
    """Return what the force of a specimen adds to k_e x under a motion [m], over k_e [m], shape (n,)."""
    answer = np.empty(motion.size)
    setting = Setting(step=time_step)
    _run_specimen(specimen.kernel.address, specimen.coefficients(setting), motion, answer)
    return answer


@compiled
def _run_specimen(address: int, coefficients: Array, motion: Array, answer: Array) -> None:
    displacement, state = np.zeros(3), np.zeros(4)
    for i in range(motion.size):
        displacement[0] = motion[i]
        answer[i] = call_kernel(
            address, pointer_to(displacement, 0), 0.0, 1.0, pointer_to(coefficients, 0), pointer_to(state, 0)
        )


def errors_with_specimens(
    specimens: Sequence[SteppedEffect], histories: Histories, structure: Partition
) -> Array:
    """Mean square of x_m − x_I [m²], its peak and that of x_I [m] with each specimen, all else as stated.

    Each gives what its force adds to k_e x, over k_e [m]; all are of one kind.
    """
    recursion = Recursion.from_displacement(structure, histories.time_step, slips=True)
    coefficients = [specimen.coefficients(Setting(step=histories.time_step)) for specimen in specimens]
    arguments = (
        *recursion.matrices[:3],
        read_only(np.ascontiguousarray(recursion.output[0])),
        float(recursion.feed_through[0, 0]),
        specimens[0].kernel.address,
        np.stack(coefficients),
        recursion.static @ np.array([histories.standing[0], 0.0]),
        histories.command[0],
        histories.measured[0],
        histories.fed_back[0],
    )
    return np.asarray(_sweep(*arguments))


@compiled
def _sweep(
    transition: Array,
    early: Array,
    late: Array,
    output: Array,
    feed_through: float,
    address: int,
    coefficients: Array,
    initial_state: Array,
    command: Array,
    measured_displacement: Array,
    fed_back: Array,
) -> Array:
    """Statistics of specimens, shape (specimens, 3); the second input is slip."""
    size, answer = command.size, np.empty((len(coefficients), 3))
    scratch, motion = np.empty(initial_state.size), np.zeros(3)
    driving = np.zeros((2, 2))
    for number in range(len(coefficients)):
        square, largest, ideal, slip = 0.0, 0.0, 0.0, 0.0
        vector = initial_state.copy()
        test, response, trial = np.zeros(4), np.zeros(4), np.zeros(4)
        gain, base = 0.0, number * coefficients.shape[1]
        for i in range(size):
            driving[0, 0], driving[1, 0] = driving[0, 1], slip
            driving[0, 1] = fed_back[i]
            motion[0] = command[i] - fed_back[i]
            force = call_kernel(
                address, pointer_to(motion, 0), 0.0, 1.0, pointer_to(coefficients, base), pointer_to(test, 0)
            )
            if i > 0:
                advance((0, 0), transition, early, late, driving, 1, vector, scratch)
                gain = _gain(output, late)
            error = feed_through * fed_back[i]
            for column in range(vector.size):
                error += output[column] * vector[column]
            slip = _slip(
                address, coefficients, base, motion, command[i] - error, gain, slip, force, response, trial
            )
            error += gain * slip
            for column in range(vector.size):
                vector[column] += late[column, 1] * slip * min(i, 1)  # the first sample begins the test
            exact = command[i] - error
            deviation = measured_displacement[i] - exact
            square += (0.5 if i in (0, size - 1) else 1.0) * deviation * deviation
            largest, ideal = max(largest, abs(deviation)), max(ideal, abs(exact))
        answer[number, 0], answer[number, 1], answer[number, 2] = square / (size - 1), largest, ideal
    return answer


@compiled
def _gain(output: Array, late: Array) -> float:
    """Error at a sample by one unit of slip there [-]."""
    total = 0.0
    for column in range(output.size):
        total += output[column] * late[column, 1]
    return total


@compiled
def _slip(
    address: int,
    coefficients: Array,
    base: int,
    motion: Array,
    linear_displacement: float,
    gain: float,
    slip: float,
    force: float,
    state: Array,
    trial: Array,
) -> float:
    """s[x_m] − s[x_c − e] at a sample [m], from that before it; moves the state of the response."""
    for _ in range(_CORRECTIONS):
        for place in range(state.size):
            trial[place] = state[place]
        motion[0] = linear_displacement - gain * slip
        slip = (
            call_kernel(
                address, pointer_to(motion, 0), 0.0, 1.0, pointer_to(coefficients, base), pointer_to(trial, 0)
            )
            - force
        )
    for place in range(state.size):
        state[place] = trial[place]
    return slip
