"""Errors of other responses than the interface's: floors and drifts that the computer had in a test.

The equation of the error (see `rebuild`) holds for the whole structure: with the interface's x_c − x_m it gives by
how much every degree of freedom strayed from the undisturbed structure, x_c − x_I, in metres. Its share of the
largest undisturbed response needs that response, which follows from the ground motion alone.
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.interval import (
    Histories,
    draw_unknown,
    inputs_of_reading,
    states_at_first_sample,
    structures_of_draws,
)
from reliab.assessment.rebuilt_error.rebuilt import RebuiltError
from reliab.assessment.rebuilt_error.recursion import Recursion, equilibrium, respond
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.assessment.rebuilt_error.whole_structure import WholeStructure

_DRAWS = 128
_RATE = 400.0  # Hz, at which the undisturbed response to a ground motion is looked at, at least


@dataclass(frozen=True, kw_only=True, eq=False)
class Ground:
    """Ground motion of a test, a straight line between its samples."""

    acceleration: Array  # a_g [m/s²], shape (n,)
    time_step: float  # s
    influence: Array  # ι, how the ground moves the degrees of freedom [-], shape (degrees of freedom,)

    def peaks(self, structure: WholeStructure, responses: Array) -> Array:
        """Largest undisturbed response of each [m], shape (responses,)."""
        finer = max(int(np.ceil(self.time_step * _RATE)), 1)
        places = np.arange(finer * (self.acceleration.size - 1) + 1) / finer
        history = np.interp(places, np.arange(self.acceleration.size), self.acceleration)
        recursion = Recursion.of_ground(structure, self.influence, self.time_step / finer)
        return np.abs(responses @ respond(recursion, history)).max(axis=1)


@dataclass(frozen=True, kw_only=True, eq=False)
class StrayedResponses:
    """By how much responses strayed from those of the undisturbed structure."""

    rms: Array  # rms, peak: RMS and largest of x_c − x_I with all as stated [m], shape (responses,)
    peak: Array
    # of_draws: RMS and largest of each draw [m], shape (2, draws, responses)
    of_draws: Array
    # largest: Peak of x_I [m] with all as stated, shape (responses,), and of each draw; None without a ground motion
    largest: Array | None
    largest_of_draws: Array | None

    def spread(self, response: int, scale: Array | float) -> Spread:
        """Draws of a response's RMS and peak over a length [m], one or that of each draw."""
        rms, peak = self.of_draws[:, :, response] / scale
        return Spread(rms=rms, mte=peak, mean=np.zeros(0), deviation=np.zeros(0))


def stray_of_responses(rebuilt: RebuiltError, responses: Array, ground: Ground | None) -> StrayedResponses:
    """Draw by how much responses strayed; `responses`: weights of the degrees of freedom, shape (responses, n).

    The specimen is linear in all draws.
    """
    histories, structure = rebuilt.histories, rebuilt.structure
    thin = histories.thinned(rebuilt.every)
    fine = _strayed(structure, responses, histories.fed_back, histories)
    coarse = _strayed(structure, responses, thin.fed_back, thin)
    between = np.divide(fine, coarse, out=np.ones_like(fine), where=coarse > 0.0)
    drawn, phase = draw_unknown(rebuilt.unknown, _DRAWS, rebuilt.seed)
    structures = structures_of_draws(structure, drawn)
    inputs, shifts = inputs_of_reading(thin, drawn)
    starts = states_at_first_sample(
        structure, drawn, phase * rebuilt.unknown.error_at_start, thin.standing
    )
    late, velocity = thin.fed_back - thin.difference, np.gradient(thin.measured, thin.time_step)
    of_draws = []
    for draw, one in enumerate(structures):
        difference = rebuilt.differences[draw % len(rebuilt.differences)] + shifts[draw] @ inputs
        fed_back = difference + late + drawn["feedback_lag"][draw] * velocity
        of_draws.append(_strayed(one, responses, fed_back, thin, starts[draw]))
    return StrayedResponses(
        rms=fine[0],
        peak=fine[1],
        of_draws=between[:, np.newaxis] * np.stack(of_draws, axis=1),
        largest=None if ground is None else ground.peaks(structure, responses),
        largest_of_draws=None
        if ground is None
        else np.stack([ground.peaks(one, responses) for one in structures]),
    )


def _strayed(
    structure: WholeStructure,
    responses: Array,
    fed_back: Array,
    histories: Histories,
    start: Array | None = None,
) -> Array:
    """RMS and largest of x_c − x_I of each response [m], shape (2, responses)."""
    recursion = Recursion.of_displacement(structure, histories.time_step, floors=True)
    state = equilibrium(structure, histories.standing) if start is None else start.copy()
    histories_of_responses = np.ascontiguousarray(responses @ respond(recursion, fed_back, state))
    squares = [mean_square(row) for row in histories_of_responses]
    return np.stack([np.sqrt(squares), np.abs(histories_of_responses).max(axis=1)])
