"""Uncertainty of the rebuilt error from tolerances, noise and an unknown initial state.

Parameters are drawn from their tolerances (scrambled Sobol points through the normal quantile function), the
histories of x_c − x_m from those that the noise allows, and the error is rebuilt for each draw. Nothing is
linearised, and no noise is subtracted from a mean square or a peak.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.error_statistics import mean_and_deviation, sweep_draws
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.assessment.rebuilt_error.own_frequency import OwnFrequency
from reliab.assessment.rebuilt_error.readings import lag_of_reading
from reliab.assessment.rebuilt_error.recursion import (
    Recursion,
    respond,
    stacked,
    states_in_motion,
    structure_of_draw,
)
from reliab.assessment.rebuilt_error.size import samples_in_step_of_structure
from reliab.assessment.rebuilt_error.sobol import normal_points
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.structures import Partition, is_part

_OF_STRUCTURE = ("frequency", "damping_ratio", "experimental_fraction", "feedback_lag")
_OPEN = ("open_offset", "open_drift", "open_filter")
_LAST = ("filter_delay", "hysteresis", "lagging_hysteresis", "sensor_drift", *_OPEN)
_FREEDOM = 4.0  # degrees of freedom of a deviation that is known by its order of magnitude
_AT_START = 1.4  # error at the first sample over what later ones show: it has the command's phase
_LEAST = 0.05  # of a stated value: a draw goes no lower
ACCURACY = 0.004  # of an error whose structure and channels are exact: 0.994 to 1.007 of the true one
_IN_PERIOD_OF_BAND = 0.25  # of the period of the highest frequency of the motion that a step may be

FEWEST_SWEPT = 4096
"""Number of samples up to which the motion's band, too, is resolved while draws are swept."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Swept:
    """Errors of the draws over a test so far, from which a later stretch of it can go on."""

    steps: int  # Number of steps between its samples
    # square, peak, ideal: Mean square of x_m − x_I [m²], its peak and that of x_I [m], shape (draws,)
    square: Array
    peak: Array
    ideal: Array
    # mean, deviation: Of x_m − x_I over the draws at the samples of the last stretch [m], shape (n,)
    mean: Array
    deviation: Array
    # State of the structure at the last sample: of the draws, and as stated by swept samples and by all,
    # shape (draws + 2, 2n)
    states: Array

    @property
    def spread(self) -> Spread:
        """RMS^R and MTE^R of the draws."""
        return Spread(
            rms=np.sqrt(self.square) / self.ideal,
            mte=self.peak / self.ideal,
            mean=self.mean,
            deviation=self.deviation,
        )

    def first(self, draws: int) -> "Swept":
        """Only the first draws."""
        return replace(
            self,
            square=self.square[:draws],
            peak=self.peak[:draws],
            ideal=self.ideal[:draws],
            states=np.concatenate([self.states[:draws], self.states[-2:]]),
        )

    def after_rest(self, steps: int) -> "Swept":
        """Errors of the same test with so many further steps of rest before it."""
        whole = self.steps + steps
        return replace(self, steps=whole, square=(self.steps / whole) * self.square)

    def joined(self, later: "Swept") -> "Swept":
        """Errors over this stretch and a later one, which begins at its last sample."""
        steps = self.steps + later.steps
        return replace(
            later,
            steps=steps,
            square=(self.steps / steps) * self.square + (later.steps / steps) * later.square,
            peak=np.maximum(self.peak, later.peak),
            ideal=np.maximum(self.ideal, later.ideal),
        )


@dataclass(frozen=True, kw_only=True)
class Unknown:
    """Standard deviations of everything that is uncertain, of a test with one sensor or with p of them."""

    tolerances: Tolerances  # Of what is stated
    # offset, error_at_start: Of the sensor offset that remains and of the error at the first sample, zero
    # where the test begins at rest [m]; of several sensors each shape (p,)
    offset: float | Array
    error_at_start: float | Array
    own_frequency: OwnFrequency | None = None  # What the test shows of its frequency, where that was learned

    def deviations(self) -> dict[str, float]:
        """Return standard deviations by name, in the order of the draws; sensors have numbers if several."""
        sizes = dict(self.tolerances.items())
        if self.own_frequency is not None:
            sizes["frequency"] = self.own_frequency.deviation
        # last and only where they are not zero, so that the draws of all others stay the same without them
        last = {name: sizes.pop(name) for name in _LAST}
        added = {**self._by_sensor(last), **self.tolerances.of_parts}
        return self._by_sensor({**sizes, "initial_state": 0.0}) | {k: v for k, v in added.items() if v}

    def _by_sensor(self, sizes: Mapping[str, float]) -> dict[str, float]:
        """Give what each sensor has of its own as often as there are sensors."""
        several, deviations = np.ndim(self.offset) > 0, {}
        for name, value in sizes.items():
            if name in _OF_STRUCTURE:
                deviations[name] = value
                continue
            own = {"sensor_offset": self.offset, "initial_state": self.error_at_start}.get(name)
            each = np.broadcast_to(value if own is None else np.hypot(value, own), np.shape(self.offset))
            for place, size in enumerate(np.atleast_1d(each).tolist()):
                numbered = f"{name}_{place + 1}" if several else name
                deviations[numbered] = size + self.tolerances.of_sensors.get(numbered, 0.0)
        return deviations


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
    structure: Partition,
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
    drawn, moving = draw_unknown(unknown, draws, seed)
    changed = structures_of_draws(structure, drawn)
    recursion = Recursion.of_displacement(changed, thin.time_step).of_draws(draws)
    at_rest = Recursion.of_displacement(structure, thin.time_step)
    if before is None:
        states = states_at_first_sample(structure, recursion, drawn["initial_state"], moving, thin.standing)
        states = np.concatenate([states, [at_rest.static[:, 0] * thin.standing] * 2])
    else:
        states = before.first(draws).states
    swept, band = _swept(thin, recursion, drawn, states[:-2], differences)
    mean, deviation = mean_and_deviation(band, draws)
    exact = {name: np.zeros(1) for name in drawn}
    (coarse,), _ = _swept(thin, at_rest.of_draws(1), exact, states[-2:-1], thin.difference[np.newaxis])
    fine = _fine_statistics(histories, structure, states[-1:])
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


def samples_in_step(structure: Partition, noise: SensorNoise, samples: int) -> int:
    """Return the number of samples of which one is enough while draws are swept."""
    of_structure = samples_in_step_of_structure(structure, noise.time_step)
    of_band = max(int(_IN_PERIOD_OF_BAND / (noise.band * noise.time_step)), 1)
    return min(of_structure, max(of_band, -(-samples // FEWEST_SWEPT)))


def draw_unknown(unknown: Unknown, draws: int, seed: int) -> tuple[dict[str, Array], Array]:
    """Draw what is unknown, each shape (draws,), and errors of the velocity at the first sample.

    The latter over the lowest natural frequency in rad/s [m], shape (draws,) or (draws, p).
    """
    deviations, sensors = unknown.deviations(), np.size(unknown.offset)
    points = normal_points(len(deviations) + sensors, draws, seed)
    at_once = _at_first_sample(points[-sensors:].T.reshape(draws, *np.shape(unknown.offset)))
    return drawn_at(points[:-sensors], deviations, unknown.own_frequency), at_once * unknown.error_at_start


def drawn_at(
    points: Array, deviations: Mapping[str, float], own_frequency: OwnFrequency | None
) -> dict[str, Array]:
    """Quantities by name at standard normal points, shape (quantities, draws)."""
    drawn = {
        name: deviations[name] * (_at_first_sample(row) if name.startswith("initial") else row)
        for name, row in zip(deviations, points, strict=True)
    }
    if own_frequency is not None:
        drawn["frequency"] = own_frequency.drawn(points[list(deviations).index("frequency")])
    for name, values in drawn.items():
        if name == "damping_ratio" or (is_part(name) and "damping" in name):
            drawn[name] = relative_ratios(values, deviations[name])
        elif name.startswith("lagging_hysteresis"):
            drawn[name] = np.maximum(values, 0.0)
        elif name.startswith(_OPEN):
            drawn[name] = np.where(values > 0.0, deviations[name], 0.0)
    if own_frequency is not None and own_frequency.entries is not None:
        return own_frequency.entries.matched(drawn)
    return drawn


def relative_ratios(drawn: Array, deviation: float) -> Array:
    """Damping ratios over the stated one, less one: the normal draws as logarithms of larger tails.

    A damping ratio is known by a factor, and its deviation to a third of itself: Student's t with four
    degrees of freedom (JCGM 100:2008, G.4.2).
    """
    return np.asarray(np.expm1(deviation * _of_larger_tails(drawn / deviation))) if deviation else drawn


def _at_first_sample(points: Array) -> Array:
    """Turn standard normal points into errors at the first sample over their deviation."""
    return _AT_START * _of_larger_tails(points)


def _of_larger_tails(points: Array) -> Array:
    """Turn standard normal points into Student's t with few degrees of freedom."""
    return np.asarray(scipy.special.stdtrit(_FREEDOM, scipy.special.ndtr(points)))


def _fine_statistics(histories: Histories, structure: Partition, state: Array) -> Array:
    """Statistics of all samples; the state moves to the last one, in place."""
    recursion = Recursion.of_displacement(structure, histories.time_step).of_draws(1)
    exact = {"feedback_lag": np.zeros(1)}
    return np.asarray(_swept(histories, recursion, exact, state, histories.difference[np.newaxis])[0][0])


def states_at_first_sample(
    structure: Partition,
    recursion: Recursion,
    displaced: Array,
    moving: Array,
    standing: Array | float,
) -> Array:
    """States of the draws, shape (draws, 2n), where an interface was displaced and in motion.

    `displaced` [m] and `moving`, its velocity over the lowest natural frequency in rad/s [m], shape (draws,)
    or (draws, p); `standing` x_c − x_m under which the structure stood still before [m].
    """
    still = recursion.static @ np.atleast_1d(standing)
    draws = len(displaced)
    if not (displaced.any() or moving.any()):
        return np.array(np.broadcast_to(still, (draws, recursion.order)))
    displaced, moving = displaced.reshape(draws, -1), moving.reshape(draws, -1)
    if structure.stiffness.ndim == 2:  # noqa: PLR2004 - one structure for all draws
        return np.asarray(still + _along_interface(structure, displaced, moving))
    each = (
        _along_interface(structure_of_draw(structure, draw), displaced[draw], moving[draw])
        for draw in range(draws)
    )
    return np.asarray(still + np.stack(list(each)))


def _along_interface(structure: Partition, displaced: Array, moving: Array) -> Array:
    """States of a structure that is displaced and moves as its interface does, shape (…, 2n)."""
    w0 = 2.0 * np.pi * float(structure.natural_frequencies[0])
    by_displacement, by_velocity = states_in_motion(structure, structure.shapes_of_interface)
    return np.asarray(displaced @ by_displacement.T + w0 * moving @ by_velocity.T)


def inputs_of_reading(thin: Histories, drawn: Mapping[str, Array]) -> tuple[Array, Array]:
    """Columns of what is drawn of the sensor, shape (columns, n), and how much each draw has of them."""
    return columns_of_sensor(thin.command, thin.measured, thin.time_step, drawn)


def columns_of_sensor(
    command: Array, measured: Array, step: float, drawn: Mapping[str, Array], number: str = ""
) -> tuple[Array, Array]:
    """Columns that a unit of what is drawn of a sensor adds to x_c − x_m, and how much each draw has of them.

    `command`, `measured` [m], shape (n,); `step` [s]; `number` ends the names of one of several sensors.
    Returns shapes (columns, n) and (draws, columns).
    """
    rate = np.gradient(measured, step)
    place = np.linspace(-0.5, 0.5, rate.size)
    every = {
        "sensor_scale": measured,
        "time_shift": rate,
        "sensor_offset": np.ones(rate.size),
        "filter_delay": rate,
        "sensor_drift": place,
        "open_offset": np.ones(rate.size),
        "open_drift": place,
        "open_filter": -rate,
    }
    columns = {f"{name}{number}": column for name, column in every.items()}
    for name in {f"hysteresis{number}", f"lagging_hysteresis{number}"} & drawn.keys():
        columns[name] = -lag_of_reading(command, float(np.std(drawn[name])))
    names = [name for name in columns if name in drawn and drawn[name].any()]
    draws = next(iter(drawn.values())).size
    inputs = np.array([columns[name] for name in names]).reshape(-1, rate.size)
    return inputs, np.array([drawn[name] for name in names]).reshape(-1, draws).T.copy()


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenDraws:
    """Draws of a test and what drives their errors, at each swept sample of the interface."""

    recursion: Recursion  # Of each draw
    states: Array  # At the first sample, shape (draws, 2n)
    command: Array  # x_c [m], shape (p, m)
    inputs: Array  # What a unit of each unknown of the sensors adds to x_c − x_m, shape (columns, p, m)
    shifts: Array  # How much each draw has of them, shape (draws, columns)
    late: Array  # What a force that is fed back late adds to x_c − x_m [m], shape (p, m)
    velocity: Array  # Of x_m [m/s], shape (p, m)
    lags: Array  # Of the force beyond the stated one [s], shape (draws,)

    def errors(self, differences: Array) -> tuple[Array, Array]:
        """Statistics of errors and their band; see `sweep_draws`, also of `differences`."""
        of_sensors = (self.inputs, self.shifts)
        of_force = (self.late, self.velocity, self.lags)
        return sweep_draws(self.recursion, self.states, self.command, differences, *of_sensors, *of_force)

    def exact(self, differences: Array) -> Iterator[Array]:
        """Responses of the interface without actuator errors [m], shape (p, m), draw by draw."""
        for draw, (state, shift, lag) in enumerate(zip(self.states, self.shifts, self.lags, strict=True)):
            strayed = differences[draw % len(differences)] + np.tensordot(shift, self.inputs, 1)
            fed_back = strayed + self.late + lag * self.velocity
            yield self.command - respond(self.recursion.of_draw(draw), fed_back, state)


def driven_draws(
    thin: Histories, recursion: Recursion, drawn: Mapping[str, Array], states: Array
) -> DrivenDraws:
    """Collect what drives the draws of a test with one actuator."""
    inputs, shifts = inputs_of_reading(thin, drawn)
    return DrivenDraws(
        recursion=recursion,
        states=states,
        command=thin.command[np.newaxis],
        inputs=inputs[:, np.newaxis],
        shifts=shifts,
        late=(thin.fed_back - thin.difference)[np.newaxis],
        velocity=np.gradient(thin.measured, thin.time_step)[np.newaxis],
        lags=drawn["feedback_lag"],
    )


def _swept(
    thin: Histories, recursion: Recursion, drawn: Mapping[str, Array], states: Array, differences: Array
) -> tuple[Array, Array]:
    """Statistics, shape (draws, 3), and the band, shape (2, n)."""
    statistics, band = driven_draws(thin, recursion, drawn, states).errors(differences[:, np.newaxis])
    return statistics[..., 0], band[:, 0]


def factors_of_draws(drawn: Mapping[str, Array]) -> list[Array]:
    """Factors of frequencies, damping ratios and the specimen's share, each shape (draws,)."""
    draws = next(iter(drawn.values())).size
    names = ("frequency", "damping_ratio", "experimental_fraction")
    f, ratio, share = (np.maximum(1.0 + drawn.get(name, np.zeros(draws)), _LEAST) for name in names)
    # a damping matrix that is stated does not change with the frequency
    return [f, ratio / f if "damping" in drawn else ratio, share]


def structures_of_draws(structure: Partition, drawn: Mapping[str, Array]) -> Partition:
    """Structures of the draws, as one whose matrices have a first axis of draws where they differ."""
    f, ratio, share = factors_of_draws(drawn)
    parts = {name: values for name, values in drawn.items() if is_part(name)}
    if parts:
        changed = [
            structure.with_parts({name: float(values[draw]) for name, values in parts.items()})
            for draw in range(f.size)
        ]
        structure = stacked(changed)
    if not (np.concatenate([f, ratio, share]) != 1.0).any():
        return structure
    return structure.scaled(frequency=f, damping_ratio=ratio, share=share)
