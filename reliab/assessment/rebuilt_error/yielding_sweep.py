"""Errors of a test if its specimen yielded, on any linear structure beside it.

A specimen that yields has the force Z x − k_e s[x], with s the displacement that its stiffness has lost by
yielding. Subtracting the equations of motion as `rebuild` does leaves ::

    M e'' + C e' + K e = γ (Z (x_c − x_m) + k_e (s[x_m] − s[x_c − e]))

the same recursion with a second input, and no ground motion is needed; a specimen that hardens loses less
than nothing. The response x_c − e at a sample
depends on the input there by (ω₀h)²/6 only, which two corrections take away. Each of several interface
displacements loses a displacement of its own.
"""

from collections.abc import Sequence

import numpy as np

from reliab.assessment.rebuilt_error.histories import Histories
from reliab.assessment.rebuilt_error.recursion import Recursion, advance
from reliab.core.arrays import Array
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
    _run_specimen(specimen.kernel.address, specimen.coefficients(Setting(step=time_step)), motion, answer)
    return answer


@compiled
def _run_specimen(address: int, coefficients: Array, motion: Array, answer: Array) -> None:
    state, scratch = np.zeros(4), np.zeros(3)
    for i in range(motion.size):
        _force(address, coefficients, motion[i : i + 1], state, answer[i : i + 1], scratch)


def errors_with_specimens(
    specimens: Sequence[Sequence[SteppedEffect]], histories: Histories, structure: Partition
) -> Array:
    """Mean square of x_m − x_I [m²], its peak and that of x_I [m], all else as stated.

    Returns them for each specimen and interface displacement, shape (specimens, p, 3). A specimen is an
    effect for each interface displacement, which gives what s adds to x there [m]; all are of one kind.
    """
    recursion = Recursion.from_displacement(structure, histories.time_step, slips=True)
    setting, degrees = Setting(step=histories.time_step), structure.degrees
    coefficients = [[effect.coefficients(setting) for effect in specimen] for specimen in specimens]
    command, measured = (histories.carry @ rows for rows in (histories.command, histories.measured))
    arguments = (
        (0,) * (2 * degrees),
        *recursion.matrices,
        specimens[0][0].kernel.address,
        np.array(coefficients, dtype=np.float64),
        recursion.static @ np.append(histories.standing, np.zeros(degrees)),
        np.ascontiguousarray(command),
        np.ascontiguousarray(measured),
        np.ascontiguousarray(histories.fed_back),
    )
    return np.asarray(_sweep(*arguments))


@compiled
def _sweep(
    inputs: tuple[int, ...],
    transition: Array,
    early: Array,
    late: Array,
    output: Array,
    feed_through: Array,
    address: int,
    coefficients: Array,
    initial_state: Array,
    command: Array,
    measured_displacement: Array,
    fed_back: Array,
) -> Array:
    """Statistics of specimens, shape (specimens, p, 3); the second half of the inputs is slip."""
    degrees, size = command.shape
    answer = np.zeros((len(coefficients), degrees, 3))
    scratch, driving = np.empty(initial_state.size), np.zeros((2 * degrees, 2))
    linear, exact, forces, motion = np.empty(degrees), np.empty(degrees), np.empty(degrees), np.zeros(3)
    slips = np.ascontiguousarray(late[:, degrees:])
    no_gain, gain = np.zeros((degrees, degrees)), output @ slips
    for number in range(len(coefficients)):
        parameters = coefficients[number].copy().reshape(-1)
        vector, slip = initial_state.copy(), np.zeros(degrees)
        test, response, trial = np.zeros(4 * degrees), np.zeros(4 * degrees), np.zeros(4 * degrees)
        for i in range(size):
            for k in range(degrees):
                driving[k, 0], driving[degrees + k, 0] = driving[k, 1], slip[k]
                driving[k, 1] = fed_back[k, i]
                exact[k] = command[k, i] - fed_back[k, i]
            _force(address, parameters, exact, test, forces, motion)
            if i > 0:
                advance(inputs, transition, early, late, driving, 1, vector, scratch)
            _subtract(command[:, i], feed_through, driving[:, 1], linear)
            _add(output, vector, -1.0, linear)
            for _ in range(_CORRECTIONS):
                _subtract(linear, gain if i > 0 else no_gain, slip, exact)
                for place in range(trial.size):
                    trial[place] = response[place]
                _force(address, parameters, exact, trial, slip, motion)
                for k in range(degrees):
                    slip[k] -= forces[k]  # s[x_m] − s[x_c − e]
            response, trial = trial, response
            _subtract(linear, gain if i > 0 else no_gain, slip, exact)
            if i > 0:  # the first sample begins the test
                _add(slips, slip, 1.0, vector)
            share = (0.5 if i in (0, size - 1) else 1.0) / (size - 1)
            for k in range(degrees):
                deviation = measured_displacement[k, i] - exact[k]
                answer[number, k, 0] += share * deviation * deviation
                answer[number, k, 1] = max(answer[number, k, 1], abs(deviation))
                answer[number, k, 2] = max(answer[number, k, 2], abs(exact[k]))
    return answer


@compiled
def _add(matrix: Array, values: Array, factor: float, result: Array) -> None:
    """Add a factor times a matrix times values, in place."""
    for row in range(matrix.shape[0]):
        for column in range(matrix.shape[1]):
            result[row] += factor * matrix[row, column] * values[column]


@compiled
def _subtract(values: Array, matrix: Array, others: Array, result: Array) -> None:
    """Write values less a matrix times others."""
    for row in range(values.size):
        result[row] = values[row]
        for column in range(matrix.shape[1]):
            result[row] -= matrix[row, column] * others[column]


@compiled
def _force(
    address: int, parameters: Array, displacements: Array, state: Array, forces: Array, motion: Array
) -> None:
    """Move a specimen to its next displacements [m], shape (p,), and write its forces over k_e.

    `motion`: three zeros to write in.
    """
    for k in range(displacements.size):
        motion[0] = displacements[k]
        forces[k] = call_kernel(
            address,
            pointer_to(motion, 0),
            0.0,
            1.0,
            pointer_to(parameters, k * (parameters.size // displacements.size)),
            pointer_to(state, 4 * k),
        )
