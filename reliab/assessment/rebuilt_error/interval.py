"""Uncertainty of the rebuilt error from tolerances, noise and an unknown initial state.

Parameters are drawn from their tolerances (scrambled Sobol points through the normal quantile function), the
histories of x_c − x_m from those that the noise allows, and the error is rebuilt for each draw. Nothing is
linearised, and no noise is subtracted from a mean square or a peak.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.error_statistics import mean_square, sweep_draws
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.assessment.rebuilt_error.recursion import Recursion, equilibrium, respond
from reliab.assessment.rebuilt_error.size import samples_in_step_of_structure
from reliab.assessment.rebuilt_error.swept import Swept
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.assessment.rebuilt_error.whole_structure import WholeStructure, first_mode

_LEAST = 0.05  # of a stated value: a draw goes no lower
_IN_PERIOD_OF_BAND = 0.25  # of the period of the highest frequency of the motion that a step may be

FEWEST_SWEPT = 4096
"""Number of samples up to which the motion's band, too, is resolved while draws are swept."""


@dataclass(frozen=True, kw_only=True)
class Unknown:
    """Standard deviations of everything that is uncertain."""

    tolerances: Tolerances  # Of what is stated
    offset: float  # Of the sensor offset that remains [m]
    error_at_start: float  # Of the error at the first sample [m]; zero where the test begins at rest

    def deviations(self) -> dict[str, float]:
        """Return standard deviations by name, in the order of the draws."""
        stated = dict(self.tolerances.items())
        stated["sensor_offset"] = float(np.hypot(stated["sensor_offset"], self.offset))
        return {**stated, "initial_state": self.error_at_start}


@dataclass(frozen=True, kw_only=True, eq=False)
class Histories:
    """Histories from which the error is rebuilt, without the sensor's offset."""

    command: Array  # command, measured: x_c and the smoothed x_m [m], shape (n,)
    measured: Array
    # x_c minus the displacement whose force was fed back [m]: x_c − x_m unless the force was late, shape (n,)
    fed_back: Array
    time_step: float  # Step [s]
    standing: float = 0.0  # x_c − x_m [m] under which the structure stood still before the first sample

    @property
    def difference(self) -> Array:
        """x_c − x_m [m], shape (n,)."""
        return self.command - self.measured

    def thinned(self, every: int) -> "Histories":
        """Each `every`-th sample."""
        return Histories(
            command=np.ascontiguousarray(self.command[::every]),
            measured=np.ascontiguousarray(self.measured[::every]),
            fed_back=np.ascontiguousarray(self.fed_back[::every]),
            time_step=every * self.time_step,
            standing=self.standing,
        )


def sweep(
    histories: Histories,
    structure: WholeStructure,
    unknown: Unknown,
    differences: Array,
    every: int,
    *,
    draws: int,
    seed: int,
    before: Swept | None = None,
) -> Swept:
    """Rebuild the error for draws of everything that is not known.

    `differences` [m].
    """
    thin = histories.thinned(every)
    deviations = unknown.deviations()
    points = _normal(len(deviations) + 1, draws, seed)
    drawn = dict(zip(deviations, points * np.array([*deviations.values(), 0.0])[:, np.newaxis], strict=False))
    band = np.zeros((2, thin.command.size))
    if before is None:
        states = _at_first_sample(structure, drawn, points[-1] * unknown.error_at_start, thin.standing)
    else:
        states = before.first(draws).states
    swept = _swept(thin, structure, drawn, states[:-2], differences, band)
    mean = band[0] / draws
    deviation = np.sqrt(np.maximum(band[1] / draws - mean**2, 0.0))
    exact = {name: np.zeros(1) for name in deviations}
    stated = thin.difference[np.newaxis]
    coarse = _swept(thin, structure, exact, states[-2:-1], stated, np.zeros_like(band))[0]
    fine = _fine_statistics(histories, structure, states[-1])
    # what lies between the swept samples
    scale = np.divide(fine, coarse, out=np.ones(3), where=coarse > 0.0)
    square, peak, ideal = (swept * scale).T
    places, known = np.arange(histories.command.size) / every, np.arange(thin.command.size)
    stretch = Swept(
        steps=histories.command.size - 1,
        square=square,
        peak=peak,
        ideal=ideal,
        mean=np.interp(places, known, mean),
        deviation=np.interp(places, known, deviation),
        states=states,
    )
    return stretch if before is None else before.first(draws).joined(stretch)


def samples_in_step(structure: WholeStructure, noise: SensorNoise, samples: int) -> int:
    """Return the number of samples of which one is enough while draws are swept."""
    of_structure = samples_in_step_of_structure(structure, noise.time_step)
    of_band = max(int(_IN_PERIOD_OF_BAND / (noise.band * noise.time_step)), 1)
    return min(of_structure, max(of_band, -(-samples // FEWEST_SWEPT)))


def _normal(dimensions: int, draws: int, seed: int) -> Array:
    points = scipy.stats.qmc.Sobol(dimensions, seed=seed).random(draws)
    return np.asarray(scipy.special.ndtri(points.T))


def _fine_statistics(histories: Histories, structure: WholeStructure, state: Array) -> Array:
    recursion = Recursion.of_displacement(structure, histories.time_step)
    response = respond(recursion, histories.fed_back, state)[0]
    error = response - histories.difference
    return np.array([mean_square(error), np.abs(error).max(), np.abs(histories.command - response).max()])


def _at_first_sample(
    structure: WholeStructure, drawn: dict[str, Array], velocity: Array, standing: float
) -> Array:
    """States of the draws, and twice the one as stated."""
    shape = first_mode(structure) / structure.specimen_stiffness
    w0 = 2.0 * np.pi * float(structure.natural_frequencies[0])
    still = equilibrium(structure, standing)
    states = np.zeros((velocity.size + 2, still.size))
    states[:-2, : shape.size] = drawn["initial_state"][:, np.newaxis] * shape
    states[:-2, shape.size :] = w0 * velocity[:, np.newaxis] * shape
    softer = np.maximum(1.0 + drawn["frequency"], _LEAST) ** -2
    states[:-2] += softer[:, np.newaxis] * still
    states[-2:] = still
    return states


def _swept(
    thin: Histories,
    structure: WholeStructure,
    drawn: dict[str, Array],
    state: Array,
    differences: Array,
    band: Array,
) -> Array:
    kinds = _recursions(structure, drawn, thin.time_step)
    rate = np.gradient(thin.measured, thin.time_step)
    inputs = np.stack([thin.measured, rate, np.ones(rate.size)])
    shifts = np.stack([drawn["sensor_scale"], drawn["time_shift"], drawn["sensor_offset"]], axis=1)
    lag = thin.fed_back - thin.difference
    return np.asarray(
        sweep_draws(
            np.stack([kind.decay for kind in kinds]),
            np.stack([kind.early for kind in kinds]),
            np.stack([kind.late for kind in kinds]),
            np.stack([kind.output[0] for kind in kinds]),
            np.array([kind.feed_through[0] for kind in kinds]),
            state,
            thin.command,
            np.ascontiguousarray(differences),
            inputs,
            np.ascontiguousarray(shifts),
            lag,
            rate,
            np.ascontiguousarray(drawn["feedback_lag"]),
            band,
        )
    )


def _recursions(structure: WholeStructure, drawn: dict[str, Array], step: float) -> list[Recursion]:
    names = ("frequency", "damping_ratio", "experimental_fraction")
    if not any(drawn[name].any() for name in names):
        return [Recursion.of_displacement(structure, step)] * drawn["frequency"].size
    return [
        Recursion.of_displacement(
            structure.scaled(
                frequency=max(1.0 + f, _LEAST),
                damping_ratio=max(1.0 + xi, _LEAST),
                share=max(1.0 + share, _LEAST),
            ),
            step,
        )
        for f, xi, share in zip(*(drawn[name] for name in names), strict=True)
    ]
