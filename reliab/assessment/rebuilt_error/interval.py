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
from reliab.assessment.rebuilt_error.hysteresis import lag_of_reading
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.assessment.rebuilt_error.own_frequency import OwnFrequency
from reliab.assessment.rebuilt_error.recursion import Recursion, equilibrium, respond
from reliab.assessment.rebuilt_error.size import samples_in_step_of_structure
from reliab.assessment.rebuilt_error.sobol import sobol_points
from reliab.assessment.rebuilt_error.swept import Swept
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.assessment.rebuilt_error.whole_structure import WholeStructure, first_mode
from reliab.structures import is_part

_OPEN = ("open_offset", "open_drift", "open_filter")
_LAST = ("filter_delay", "hysteresis", "lagging_hysteresis", "sensor_drift", *_OPEN)
_FREEDOM = 4.0  # degrees of freedom of the deviation of a damping ratio
_LEAST = 0.05  # of a stated value: a draw goes no lower
ACCURACY = 0.004  # of an error whose structure and channels are exact: 0.994 to 1.007 of the true one
_IN_PERIOD_OF_BAND = 0.25  # of the period of the highest frequency of the motion that a step may be

FEWEST_SWEPT = 4096
"""Number of samples up to which the motion's band, too, is resolved while draws are swept."""


@dataclass(frozen=True, kw_only=True)
class Unknown:
    """Standard deviations of everything that is uncertain."""

    tolerances: Tolerances  # Of what is stated
    offset: float  # Of the sensor offset that remains [m]
    error_at_start: float  # Of the error at the first sample [m]; zero where the test begins at rest
    own_frequency: OwnFrequency | None = None  # What the test shows of its frequency, where that was learned

    def deviations(self) -> dict[str, float]:
        """Return standard deviations by name, in the order of the draws."""
        stated = dict(self.tolerances.items())
        if self.own_frequency is not None:
            stated["frequency"] = self.own_frequency.deviation
        stated["sensor_offset"] = float(np.hypot(stated["sensor_offset"], self.offset))
        # last and only where they are not zero, so that the draws of all others stay the same without them
        added = {**{name: stated.pop(name) for name in _LAST}, **self.tolerances.of_parts}
        return {**stated, "initial_state": self.error_at_start} | {k: v for k, v in added.items() if v}


EXACT = Unknown(tolerances=Tolerances(), offset=0.0, error_at_start=0.0)
"""Nothing is uncertain but noise."""


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
    drawn, phase = draw_unknown(unknown, draws, seed)
    band = np.zeros((2, thin.command.size))
    if before is None:
        states = states_at_first_sample(structure, drawn, phase * unknown.error_at_start, thin.standing)
    else:
        states = before.first(draws).states
    swept = _swept(thin, structure, drawn, states[:-2], differences, band)
    mean = band[0] / draws
    deviation = np.sqrt(np.maximum(band[1] / draws - mean**2, 0.0))
    exact = {name: np.zeros(1) for name in drawn}
    stated = thin.difference[np.newaxis]
    coarse = _swept(thin, structure, exact, states[-2:-1], stated, np.zeros_like(band))[0]
    fine = _fine_statistics(histories, structure, states[-1])
    # what lies between the swept samples
    scale = np.divide(fine, coarse, out=np.ones(3), where=coarse > 0.0)
    square, peak, ideal = (swept * scale).T
    if unknown.own_frequency is not None:  # whose error is the largest: what the computation adds shows there
        computed = 1.0 + ACCURACY * np.random.default_rng(seed).standard_normal(draws)
        square, peak = computed**2 * square, computed * peak
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


def draw_unknown(unknown: Unknown, draws: int, seed: int) -> tuple[dict[str, Array], Array]:
    """Draw what is unknown, each shape (draws,), and a standard normal velocity at the first sample."""
    deviations = unknown.deviations()
    points = normal_points(len(deviations) + 1, draws, seed)
    drawn = {name: row * deviations[name] for name, row in zip(deviations, points, strict=False)}
    if unknown.own_frequency is not None:
        drawn["frequency"] = unknown.own_frequency.drawn(points[list(deviations).index("frequency")])
    of_damping = {name for name in drawn if is_part(name) and "damping" in name}
    for name in {"damping_ratio", *of_damping}:
        drawn[name] = relative_ratios(drawn[name], deviations[name])
    if "lagging_hysteresis" in drawn:
        drawn["lagging_hysteresis"] = np.maximum(drawn["lagging_hysteresis"], 0.0)
    for name in _OPEN:
        if name in drawn:
            drawn[name] = np.where(drawn[name] > 0.0, deviations[name], 0.0)
    return drawn, points[-1]


def relative_ratios(drawn: Array, deviation: float) -> Array:
    """Damping ratios over the stated one, less one: the normal draws as logarithms of larger tails.

    A damping ratio is known by a factor, and its deviation to a third of itself: Student's t with four
    degrees of freedom (JCGM 100:2008, G.4.2).
    """
    if not deviation:
        return drawn
    shares = scipy.special.ndtr(drawn / deviation)
    return np.asarray(np.expm1(deviation * scipy.special.stdtrit(_FREEDOM, shares)))


def normal_points(dimensions: int, draws: int, seed: int) -> Array:
    """Scrambled Sobol points through the normal quantile function, shape (dimensions, draws)."""
    if dimensions == 0:
        return np.zeros((0, draws))
    return np.asarray(scipy.special.ndtri(sobol_points(dimensions, draws, seed).T))


def _fine_statistics(histories: Histories, structure: WholeStructure, state: Array) -> Array:
    recursion = Recursion.of_displacement(structure, histories.time_step)
    response = respond(recursion, histories.fed_back, state)[0]
    error = response - histories.difference
    return np.array([mean_square(error), np.abs(error).max(), np.abs(histories.command - response).max()])


def states_at_first_sample(
    structure: WholeStructure, drawn: dict[str, Array], velocity: Array, standing: float
) -> Array:
    """States of the draws, and twice the one as stated."""
    shape = first_mode(structure) / structure.specimen_stiffness
    w0 = 2.0 * np.pi * float(structure.natural_frequencies[0])
    still = equilibrium(structure, standing)
    states = np.zeros((velocity.size + 2, still.size))
    states[:-2, : shape.size] = drawn["initial_state"][:, np.newaxis] * shape
    states[:-2, shape.size :] = w0 * velocity[:, np.newaxis] * shape
    if standing and any(is_part(name) for name in drawn):
        structures = structures_of_draws(structure, drawn)
        states[:-2] += [equilibrium(changed, standing) for changed in structures]
    else:
        softer = np.maximum(1.0 + drawn["frequency"], _LEAST) ** -2
        states[:-2] += softer[:, np.newaxis] * still
    states[-2:] = still
    return states


def columns_of_reading(thin: Histories, drawn: dict[str, Array]) -> dict[str, Array]:
    """Give what one unit of each unknown of the sensor adds to x_c − x_m, each shape (n,)."""
    rate = np.gradient(thin.measured, thin.time_step)
    place = np.linspace(-0.5, 0.5, rate.size)
    columns = {
        "sensor_scale": thin.measured,
        "time_shift": rate,
        "sensor_offset": np.ones(rate.size),
        "filter_delay": rate,
        "sensor_drift": place,
        "open_offset": np.ones(rate.size),
        "open_drift": place,
        "open_filter": -rate,
    }
    for name in {"hysteresis", "lagging_hysteresis"} & drawn.keys():
        columns[name] = -lag_of_reading(thin.command, float(np.std(drawn[name])))
    return columns


def inputs_of_reading(thin: Histories, drawn: dict[str, Array]) -> tuple[Array, Array]:
    """Columns of what is drawn of the sensor, shape (columns, n), and how much each draw has of them."""
    columns = columns_of_reading(thin, drawn)
    names = [name for name in columns if name in drawn and drawn[name].any()]
    inputs = np.array([columns[name] for name in names]).reshape(-1, thin.command.size)
    return inputs, np.array([drawn[name] for name in names]).reshape(-1, drawn["frequency"].size).T.copy()


def _swept(
    thin: Histories,
    structure: WholeStructure,
    drawn: dict[str, Array],
    state: Array,
    differences: Array,
    band: Array,
) -> Array:
    recursion = recursion_of_draws(structure, drawn, thin.time_step)
    inputs, shifts = inputs_of_reading(thin, drawn)
    return np.asarray(
        sweep_draws(
            recursion.decay,
            recursion.early,
            recursion.late,
            recursion.output,
            recursion.feed_through,
            state,
            thin.command,
            np.ascontiguousarray(differences),
            inputs,
            shifts,
            thin.fed_back - thin.difference,
            np.gradient(thin.measured, thin.time_step),
            np.ascontiguousarray(drawn["feedback_lag"]),
            band,
        )
    )


def recursion_of_draws(structure: WholeStructure, drawn: dict[str, Array], step: float) -> Recursion:
    """Recursions of the draws; where none of the structure's parameters is drawn all are the same."""
    factors = factors_of_draws(drawn)
    if any(is_part(name) for name in drawn):
        return Recursion.of_structures(structures_of_draws(structure, drawn), step)
    if any((factor != 1.0).any() for factor in factors):
        f, xi, share = factors
        return Recursion.of_scaled(structure, step, frequency=f, damping_ratio=xi, share=share)
    same, draws = Recursion.of_displacement(structure, step), factors[0].size
    return Recursion(
        decay=np.stack([same.decay] * draws),
        early=np.stack([same.early] * draws),
        late=np.stack([same.late] * draws),
        output=np.stack([same.output[0]] * draws),
        feed_through=np.full(draws, same.feed_through[0]),
    )


def factors_of_draws(drawn: dict[str, Array]) -> list[Array]:
    """Factors of frequencies, damping ratios and the specimen's share, each shape (draws,)."""
    names = ("frequency", "damping_ratio", "experimental_fraction")
    f, ratio, share = (np.maximum(1.0 + drawn[name], _LEAST) for name in names)
    # a damping matrix that is stated does not change with the frequency
    return [f, ratio / f if "damping" in drawn else ratio, share]


def structures_of_draws(structure: WholeStructure, drawn: dict[str, Array]) -> list[WholeStructure]:
    """Structure of each draw."""
    parts = {name: values for name, values in drawn.items() if is_part(name)}
    return [
        structure.with_parts({name: float(values[draw]) for name, values in parts.items()}).scaled(
            frequency=float(f), damping_ratio=float(ratio), share=float(share)
        )
        for draw, (f, ratio, share) in enumerate(zip(*factors_of_draws(drawn), strict=True))
    ]
