"""Errors of other responses than the interface's: floors and drifts that the computer had in a test.

The equation of the error (see `rebuild`) holds for the whole structure: with the interface's x_c − x_m it
gives by how much every degree of freedom strayed from the undisturbed structure, x_c − x_I, in metres. Its
share of the largest undisturbed response needs that response, which follows from the ground motion. A
frequency that is 2 % off makes it wrong by some ten per cent, at all floors nearly alike; the test shows it
at the interface, to whose peak the others are scaled.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.interval import (
    ACCURACY,
    Histories,
    draw_unknown,
    inputs_of_reading,
    states_at_first_sample,
    structures_of_draws,
)
from reliab.assessment.rebuilt_error.rebuilt import RebuiltError
from reliab.assessment.rebuilt_error.recursion import Recursion, respond, structure_of_draw
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.structures import Partition

_DRAWS = 128
_OF_SCALED_PEAKS = 0.01  # that peaks are off which are scaled to the interface's, where modes differ
_RATE = 400.0  # Hz, at which the undisturbed response to a ground motion is looked at, at least


@dataclass(frozen=True, kw_only=True, eq=False)
class Ground:
    """Ground motion of a test, a straight line between its samples."""

    acceleration: Array  # a_g [m/s²], shape (n,)
    time_step: float  # s
    influence: Array  # ι, how the ground moves the degrees of freedom [-], shape (degrees of freedom,)

    @property
    def _finer(self) -> int:
        """Steps in that of the ground motion."""
        return max(int(np.ceil(self.time_step * _RATE)), 1)

    def recursion(self, structure: Partition) -> Recursion:
        """Recursion to the undisturbed responses of all degrees of freedom."""
        return Recursion.of_ground(structure, self.influence, self.time_step / self._finer)

    def peaks(self, recursion: Recursion, responses: Array) -> Array:
        """Largest undisturbed response of each [m], shape (responses,)."""
        places = np.arange(self._finer * (self.acceleration.size - 1) + 1) / self._finer
        history = np.interp(places, np.arange(self.acceleration.size), self.acceleration)
        return np.asarray(np.abs(responses @ respond(recursion, history)).max(axis=1))


@dataclass(frozen=True, kw_only=True, eq=False)
class StrayedResponses:
    """By how much responses strayed from those of the undisturbed structure."""

    sizes: Array  # RMS and largest of x_c − x_I with all as stated [m], shape (2, responses)
    of_draws: Array  # The same of each draw, shape (draws, 2, responses)
    largest: Array | None  # Peaks of x_I with all as stated [m], shape (responses,); None without a motion
    largest_of_draws: Array | None  # The same of each draw, shape (draws, responses)
    # Peak of the interface under the ground motion over that in the test, less changed [-]
    disagreement: float | None

    def spread(self, response: int, scale: Array | float) -> Spread:
        """Draws of a response's RMS and peak over a length [m], one or that of each draw."""
        rms, peak = self.of_draws[:, :, response].T / scale
        return Spread(rms=rms, mte=peak, mean=np.zeros(0), deviation=np.zeros(0))


def stray_of_responses(rebuilt: RebuiltError, responses: Array, ground: Ground | None) -> StrayedResponses:
    """Draw by how much responses strayed.

    `responses`: weights of the degrees of freedom [-], shape (responses, n). All specimens are linear.
    """
    histories, structure = rebuilt.histories, rebuilt.structure
    thin = histories.thinned(rebuilt.every)
    rows = np.vstack([responses, structure.interface.T])
    fine, coarse = (
        _strayed(Recursion.of_displacement(structure, one.time_step, floors=True), rows, one.fed_back, one)
        for one in (histories, thin)
    )
    between = np.divide(fine, coarse, out=np.ones_like(fine), where=coarse > 0.0)
    drawn, phase = draw_unknown(rebuilt.unknown, _DRAWS, rebuilt.seed)
    structures = structures_of_draws(structure, drawn)
    strayed = _strayed_draws(rebuilt, thin, rows, structures, drawn, phase)
    of_draws = between * strayed
    chance = np.random.default_rng(rebuilt.seed).standard_normal((2, _DRAWS, 1))
    if rebuilt.unknown.own_frequency is not None:  # whose error is the largest: as in `sweep`
        of_draws[:, :2] *= 1.0 + ACCURACY * chance[0][..., np.newaxis]
    if ground is None:
        peaks = peaks_of_draws = disagreement = None
    else:
        peaks, of_interface = _peaks(ground, ground.recursion(structure), rows, fine)
        under_ground = ground.recursion(structures).of_draws(_DRAWS)
        peaks_of_draws = (1.0 + _OF_SCALED_PEAKS * chance[1]) * np.stack(
            [
                _peaks(ground, under_ground.of_draw(draw), rows, sizes)[0]
                for draw, sizes in enumerate(of_draws)
            ]
        )
        disagreement = of_interface / float(fine[2, -1]) - 1.0
    return StrayedResponses(
        sizes=fine[:2, :-1],
        of_draws=of_draws[:, :2, :-1],
        largest=peaks,
        largest_of_draws=peaks_of_draws,
        disagreement=disagreement,
    )


def _strayed_draws(
    rebuilt: RebuiltError,
    thin: Histories,
    rows: Array,
    structures: Partition,
    drawn: dict[str, Array],
    phase: Array,
) -> Array:
    """Sizes as of `_strayed` of each draw, shape (draws, 3, responses)."""
    recursions = Recursion.of_displacement(structures, thin.time_step, floors=True).of_draws(_DRAWS)
    strayed = [
        _strayed(recursions.of_draw(draw), rows, fed_back, thin, start)
        for draw, (fed_back, start) in enumerate(_driven(rebuilt, thin, recursions, drawn, phase))
    ]
    return np.array(strayed)


def exact_of_draws(rebuilt: RebuiltError, number: int) -> Iterator[tuple[Partition, Array]]:
    """Structures and responses at the interface without actuator errors [m], draw by draw, shape (1, m)."""
    thin = rebuilt.histories.thinned(rebuilt.every)
    drawn, phase = draw_unknown(rebuilt.unknown, number, rebuilt.seed)
    structures = structures_of_draws(rebuilt.structure, drawn)
    recursions = Recursion.of_displacement(structures, thin.time_step).of_draws(number)
    for draw, (fed_back, start) in enumerate(_driven(rebuilt, thin, recursions, drawn, phase)):
        response = respond(recursions.of_draw(draw), fed_back, start)
        yield structure_of_draw(structures, draw), thin.command - response


def _driven(
    rebuilt: RebuiltError, thin: Histories, recursions: Recursion, drawn: dict[str, Array], phase: Array
) -> Iterator[tuple[Array, Array]]:
    """x_c − x_m of the force that was fed back [m] and state at the first sample, draw by draw."""
    inputs, shifts = inputs_of_reading(thin, drawn)
    starts = states_at_first_sample(
        rebuilt.structure,
        recursions,
        drawn["initial_state"],
        phase * rebuilt.unknown.error_at_start,
        thin.standing,
    )
    late, velocity = thin.fed_back - thin.difference, np.gradient(thin.measured, thin.time_step)
    for draw, start in enumerate(starts):
        difference = rebuilt.differences[draw % len(rebuilt.differences)] + shifts[draw] @ inputs
        yield difference + late + drawn["feedback_lag"][draw] * velocity, start


def _peaks(ground: Ground, recursion: Recursion, rows: Array, sizes: Array) -> tuple[Array, float]:
    """Peaks of the undisturbed responses [m], and that of the interface under the ground motion alone."""
    under_ground = ground.peaks(recursion, rows)
    of_interface = float(under_ground[-1])
    return under_ground[:-1] * (sizes[2, -1] / of_interface), of_interface


def _strayed(
    recursion: Recursion, rows: Array, fed_back: Array, histories: Histories, start: Array | None = None
) -> Array:
    """RMS and largest of x_c − x_I of each response [m], and largest x_I of the last, the interface.

    Shape (3, responses).
    """
    state = recursion.static[:, 0] * histories.standing if start is None else start
    strayed = np.ascontiguousarray(rows @ respond(recursion, fed_back, state))
    squares = [mean_square(row) for row in strayed]
    ideal = np.full(len(rows), np.abs(histories.command - strayed[-1]).max())
    return np.stack([np.sqrt(squares), np.abs(strayed).max(axis=1), ideal])
