"""What tolerances, noise and the unknown beginning leave open of the error.

Parameters are drawn from their tolerances (scrambled Sobol points through the normal quantile function), the
error is rebuilt for each draw, and what sensor noise adds to mean square and peak is taken from noise
histories that run through the same recursion. Nothing is linearised: a mean square that noise may explain
whole reaches down to zero.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm, qmc

from reliab.rebuilt_error.error_statistics import mean_square, sweep_draws
from reliab.rebuilt_error.noise_share import NoiseShare, thinning
from reliab.rebuilt_error.recursion import Recursion, respond
from reliab.rebuilt_error.tolerances import Tolerances
from reliab.rebuilt_error.whole_structure import WholeStructure, first_mode

Array = NDArray[np.float64]

LEVEL = 0.90
"""Level of the intervals."""

HALF_WIDTH = float(norm.ppf(0.5 + 0.5 * LEVEL))
"""Half width of a 90 % interval in standard deviations."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A value with its 90 % interval.

    Attributes
    ----------
    value, low, high : float
        Relative errors [-].
    """

    value: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class Unknown:
    """How far everything that is not known may be off, as standard deviations.

    Attributes
    ----------
    tolerances : Tolerances
        Of what is stated.
    offset : float
        Of what is left of the sensor's offset [m].
    error_at_start : float
        Of the error at the first sample [m]; zero where the test begins at rest.
    """

    tolerances: Tolerances
    offset: float
    error_at_start: float

    def deviations(self) -> dict[str, float]:
        """Return standard deviations by name, in the order of the draws."""
        stated = dict(self.tolerances.items())
        stated["sensor_offset"] = float(np.hypot(stated["sensor_offset"], self.offset))
        return {**stated, "initial_state": self.error_at_start}


@dataclass(frozen=True, kw_only=True, eq=False)
class Histories:
    """What the error is rebuilt from, without the sensor's offset.

    Attributes
    ----------
    command, measured : numpy.ndarray
        x_c and the smoothed x_m [m], shape (n,).
    fed_back : numpy.ndarray
        x_c minus the displacement whose force was fed back [m]: x_c − x_m unless the force was late,
        shape (n,).
    time_step : float
        Step [s].
    """

    command: Array
    measured: Array
    fed_back: Array
    time_step: float

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
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Spread:
    """Errors of many draws.

    Attributes
    ----------
    mean_square, peak, ideal_peak : numpy.ndarray
        Of x_m − x_I [m²], [m], and of x_I [m], shape (draws,).
    deviation : numpy.ndarray
        Standard deviation of x_m − x_I over the draws at the samples [m], shape (n,).
    """

    mean_square: Array
    peak: Array
    ideal_peak: Array
    deviation: Array


def sweep(histories: Histories, structure: WholeStructure, unknown: Unknown, draws: int, seed: int) -> Spread:
    """Rebuild the error for draws of everything that is not known.

    Parameters
    ----------
    histories : Histories
        Command and measured displacement.
    structure : WholeStructure
        The structure as stated.
    unknown : Unknown
        Standard deviations.
    draws : int
        Number of draws, a power of two.
    seed : int
        Seed of the draws; the same seed draws the same numbers for other standard deviations.

    Returns
    -------
    Spread
        Statistics of the error, as fine as the given histories.
    """
    every = thinning(structure, histories.time_step)
    thin = histories.thinned(every)
    deviations = unknown.deviations()
    points = _normal(len(deviations) + 1, draws, seed)
    drawn = dict(zip(deviations, points * np.array([*deviations.values(), 0.0])[:, np.newaxis], strict=False))
    band = np.zeros((2, thin.command.size))
    swept = _swept(thin, structure, drawn, points[-1] * unknown.error_at_start, band)
    mean = band[0] / draws
    deviation = np.sqrt(np.maximum(band[1] / draws - mean**2, 0.0))
    places = np.arange(histories.command.size) / every
    exact = _swept(
        thin, structure, {name: np.zeros(1) for name in deviations}, np.zeros(1), np.zeros_like(band)
    )[0]
    fine = _fine_statistics(histories, structure)
    scale = np.divide(fine, exact, out=np.ones(3), where=exact > 0.0)
    return Spread(
        mean_square=swept[:, 0] * scale[0],
        peak=swept[:, 1] * scale[1],
        ideal_peak=swept[:, 2] * scale[2],
        deviation=np.interp(places, np.arange(thin.command.size), deviation),
    )


def _normal(dimensions: int, draws: int, seed: int) -> Array:
    points = qmc.Sobol(dimensions, seed=seed).random(draws)
    return np.asarray(norm.ppf(points.T))


def _fine_statistics(histories: Histories, structure: WholeStructure) -> Array:
    recursion = Recursion.of_displacement(structure, histories.time_step)
    response = respond(recursion, histories.fed_back)[0]
    error = response - histories.difference
    return np.array([mean_square(error), np.abs(error).max(), np.abs(histories.command - response).max()])


def _swept(
    thin: Histories, structure: WholeStructure, drawn: dict[str, Array], velocity: Array, band: Array
) -> Array:
    kinds = _recursions(structure, drawn, thin.time_step)
    draws = drawn["frequency"].size
    state = np.zeros((draws, kinds[0].order))
    shape = first_mode(structure) / structure.specimen_stiffness
    w0 = 2.0 * np.pi * float(structure.natural_frequencies[0])
    state[:, : shape.size] = drawn["initial_state"][:, np.newaxis] * shape
    state[:, shape.size :] = w0 * velocity[:, np.newaxis] * shape
    rate = np.gradient(thin.measured, thin.time_step)
    inputs = np.stack([thin.difference, thin.measured, rate, np.ones(rate.size)])
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
    least = 0.05
    return [
        Recursion.of_displacement(
            structure.scaled(
                frequency=max(1.0 + f, least),
                damping_ratio=max(1.0 + xi, least),
                share=max(1.0 + share, least),
            ),
            step,
        )
        for f, xi, share in zip(*(drawn[name] for name in names), strict=True)
    ]


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorDraws:
    """RMS^R and MTE^R of the draws, noise taken away.

    Attributes
    ----------
    rms, mte : numpy.ndarray
        Relative errors [-], shape (draws,).
    """

    rms: Array
    mte: Array


def combine(spread: Spread, share: NoiseShare, seed: int) -> ErrorDraws:
    """Take drawn noise away from drawn errors.

    In the mean only what white noise adds is taken from a peak, as from its value: what passes for slow noise
    may be the actuator's own doing.
    """
    draws = spread.peak.size
    order = np.random.default_rng(seed).permutation(np.arange(draws) % share.in_square.size)
    square = np.maximum(spread.mean_square - share.in_square[order], 0.0)
    in_peak = share.in_peak - share.in_peak.mean() + share.white_in_peak
    peak = np.maximum(spread.peak - in_peak[order], 0.0)
    return ErrorDraws(rms=np.sqrt(square) / spread.ideal_peak, mte=peak / spread.ideal_peak)


def estimate(value: float, draws: Array) -> Estimate:
    """Value and 90 % interval, which holds the value."""
    low, high = np.quantile(draws, [0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL])
    return Estimate(value=value, low=float(min(low, value)), high=float(max(high, value)))


def probability_below(draws: Array, threshold: float) -> float:
    """Probability of an error below a threshold, no nearer to 0 and 1 than the number of draws can tell."""
    return (float(np.count_nonzero(draws < threshold)) + 0.5) / (draws.size + 1.0)
