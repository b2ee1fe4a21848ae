"""Exact responses of a test at its interface, draw by draw of what is not known, for a linear specimen."""

from collections.abc import Iterator

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.interval import (
    Histories,
    draw_unknown,
    inputs_of_reading,
    states_at_first_sample,
    structures_of_draws,
)
from reliab.assessment.rebuilt_error.rebuilt import RebuiltError
from reliab.assessment.rebuilt_error.recursion import Recursion, respond, structure_of_draw
from reliab.structures import Partition


def exact_of_draws(rebuilt: RebuiltError, number: int) -> Iterator[tuple[Partition, Array]]:
    """Structures and responses at the interface without actuator errors [m], draw by draw, shape (1, m)."""
    thin = rebuilt.histories.thinned(rebuilt.every)
    drawn, moving = draw_unknown(rebuilt.unknown, number, rebuilt.seed)
    structures = structures_of_draws(rebuilt.structure, drawn)
    recursions = Recursion.of_displacement(structures, thin.time_step).of_draws(number)
    for draw, (fed_back, start) in enumerate(_driven(rebuilt, thin, recursions, drawn, moving)):
        response = respond(recursions.of_draw(draw), fed_back, start)
        yield structure_of_draw(structures, draw), thin.command - response


def _driven(
    rebuilt: RebuiltError, thin: Histories, recursions: Recursion, drawn: dict[str, Array], moving: Array
) -> Iterator[tuple[Array, Array]]:
    """x_c − x_m of the force that was fed back [m] and state at the first sample, draw by draw."""
    inputs, shifts = inputs_of_reading(thin, drawn)
    starts = states_at_first_sample(
        rebuilt.structure,
        recursions,
        drawn["initial_state"],
        moving,
        thin.standing,
    )
    late, velocity = thin.fed_back - thin.difference, np.gradient(thin.measured, thin.time_step)
    for draw, start in enumerate(starts):
        difference = rebuilt.differences[draw % len(rebuilt.differences)] + shifts[draw] @ inputs
        yield difference + late + drawn["feedback_lag"][draw] * velocity, start
