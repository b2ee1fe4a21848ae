"""Errors of draws with a specimen that yields, on any linear structure beside it.

A specimen that yields has the force Z x − k_e s[x], with s the displacement that its stiffness has lost by
yielding. Subtracting the equations of motion as `rebuild` does leaves ::

    M e'' + C e' + K e = γ (Z (x_c − x_m) + k_e (s[x_m] − s[x_c − e]))

the same recursion with a second input, and no ground motion is needed; a specimen that hardens loses less
than nothing. The response x_c − e at a sample
depends on the input there by (ω₀h)²/6 only, which two corrections take away.
"""

from collections.abc import Sequence

import numpy as np

from reliab.assessment.rebuilt_error.error_statistics import tally
from reliab.assessment.rebuilt_error.interval import (
    EXACT,
    Histories,
    inputs_of_reading,
    states_at_first_sample,
    structures_of_draws,
)
from reliab.assessment.rebuilt_error.recursion import Recursion, advance
from reliab.core.arrays import Array, read_only
from reliab.core.compiled import compiled
from reliab.core.threads import run_in_two_shares
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
    draws = len(specimens)
    exact = {name: np.zeros(draws) for name in EXACT.deviations()}
    difference = histories.difference[np.newaxis]
    reading = inputs_of_reading(histories, exact)
    return _swept(specimens, histories, structure, exact, np.zeros(draws), difference, reading)[0]


def _swept(
    specimens: Sequence[SteppedEffect],
    thin: Histories,
    structure: Partition,
    quantities: dict[str, Array],
    velocity: Array,
    differences: Array,
    reading: tuple[Array, Array],
) -> tuple[Array, Array]:
    """Statistics of the draws, shape (draws, 3), and the band, shape (2, n); see `DrivenDraws`."""
    structures = structures_of_draws(structure, quantities)
    recursion = Recursion.from_displacement(structures, thin.time_step, slips=True).expand_draws(
        len(specimens)
    )
    standing = np.array([thin.standing, 0.0])
    initial_states = states_at_first_sample(
        structure, recursion, quantities["initial_state"], velocity, standing
    )
    columns, shifts = reading
    setting = Setting(step=thin.time_step)
    transition, early, late, output, feed_through = recursion.matrices
    arguments = (
        transition,
        early,
        late,
        read_only(np.ascontiguousarray(output[:, 0])),
        read_only(np.ascontiguousarray(feed_through[:, 0, 0])),
        specimens[0].kernel.address,
        np.stack([specimen.coefficients(setting) for specimen in specimens]),
        initial_states,
        thin.command,
        np.ascontiguousarray(differences),
        columns,
        shifts,
        thin.fed_back - thin.difference,
        np.gradient(thin.measured, thin.time_step),
        np.ascontiguousarray(quantities["feedback_lag"]),
    )
    answer = np.empty((len(specimens), 3))

    def sweep(share: slice) -> Array:
        band = np.zeros((2, thin.command.size))
        _sweep(*arguments, share.start, share.stop, answer, band)
        return band

    return answer, np.sum(run_in_two_shares(len(specimens), sweep), axis=0)


@compiled
def _sweep(
    transition: Array,
    early: Array,
    late: Array,
    output: Array,
    feed_through: Array,
    address: int,
    coefficients: Array,
    state: Array,
    command: Array,
    differences: Array,
    inputs: Array,
    shifts: Array,
    fed_back_late: Array,
    velocity: Array,
    feedback_lag: Array,
    begin: int,
    end: int,
    answer: Array,
    band: Array,
) -> None:
    """Statistics as of `DrivenDraws` and the band, in place; the second input is slip."""
    size = command.size
    scratch, motion = np.empty(state.shape[1]), np.zeros(3)
    driving = np.zeros((2, 2))
    for draw in range(begin, end):
        row = draw % differences.shape[0]
        sums = (0.0, 0.0, 0.0)
        slip = 0.0
        vector = state[draw]
        test, response, trial = np.zeros(4), np.zeros(4), np.zeros(4)
        gain, base = 0.0, draw * coefficients.shape[1]
        for i in range(size):
            difference = differences[row, i]
            for k in range(inputs.shape[0]):
                difference += shifts[draw, k] * inputs[k, i]
            driving[0, 0], driving[1, 0] = driving[0, 1], slip
            now = difference + fed_back_late[i] + feedback_lag[draw] * velocity[i]
            driving[0, 1] = now
            motion[0] = command[i] - now
            force = call_kernel(
                address, pointer_to(motion, 0), 0.0, 1.0, pointer_to(coefficients, base), pointer_to(test, 0)
            )
            if i > 0:
                advance((0, 0), transition[draw], early[draw], late[draw], driving, 1, vector, scratch)
                gain = _gain(output[draw], late[draw])
            error = feed_through[draw] * now
            for column in range(vector.size):
                error += output[draw, column] * vector[column]
            slip = _slip(
                address, coefficients, base, motion, command[i] - error, gain, slip, force, response, trial
            )
            error += gain * slip
            for column in range(vector.size):
                vector[column] += late[draw, column, 1] * slip * min(i, 1)  # the first sample begins the test
            weight = 0.5 if i in (0, size - 1) else 1.0
            sums = tally(sums, error - difference, command[i] - error, weight, band, i)
        answer[draw, 0], answer[draw, 1], answer[draw, 2] = sums[0] / (size - 1), sums[1], sums[2]


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
