"""The natural frequency that a test with several actuators shows of its structure.

It is learned as with one actuator (see `rebuilt_error/own_frequency.py`), from the interface displacement
whose motion in the lowest mode strains the specimen most.
"""

from collections.abc import Iterator

import numpy as np

from reliab.arrays import Array
from reliab.assessment.coupled_error.coupled_histories import CoupledHistories
from reliab.assessment.coupled_error.coupled_recursion import CoupledRecursion
from reliab.assessment.rebuilt_error.own_frequency import Felt, OwnFrequency, samples_to_learn
from reliab.structures import CoupledPartition


def learn_frequency(
    histories: CoupledHistories, structure: CoupledPartition, deviation: float
) -> OwnFrequency | None:
    """Learn the lowest frequency beside a stated one; None where it is exact or the test is short.

    `deviation` of the stated frequencies, relative.
    """
    frequencies, ratios, moved = structure.modes
    every = samples_to_learn(histories.command.shape[1], histories.time_step, float(frequencies[0]))
    if not deviation or every is None:
        return None
    place = int(np.argmax(np.diag(structure.specimen_stiffness) * moved[:, 0] ** 2))
    step = every * histories.time_step
    command, drive, difference = (
        np.ascontiguousarray(history[:, ::every])
        for history in (histories.carry @ histories.command, histories.fed_back, histories.difference)
    )

    def responses(factors: Array) -> Iterator[tuple[Array, Array]]:
        for factor in factors.tolist():
            scaled = structure.scaled(frequency=factor, damping_ratio=1.0, share=1.0)
            moving = histories.respond(CoupledRecursion.of_partition(scaled, step), drive)[place]
            yield command[place] - moving, moving - difference[place]

    omega = 2.0 * np.pi * float(frequencies[0])
    felt = Felt(
        time_step=step,
        frequencies=frequencies,
        first_mode=(omega, 2.0 * float(ratios[0]) * omega),
        responses=responses,
    )
    return felt.learn(deviation)
