"""Uncertainty of the rebuilt error from tolerances, noise and an unknown initial state.

Parameters are drawn from their tolerances (scrambled Sobol points through the normal quantile function), the
histories of x_c − x_m from those that the noise allows, and the error is rebuilt for each draw. Nothing is
linearised, and no noise is subtracted from a mean square or a peak.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from reliab.assessment.rebuilt_error.error_statistics import DrivenDraws, mean_and_deviation
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.assessment.rebuilt_error.readings import lag_of_reading
from reliab.assessment.rebuilt_error.recursion import (
    Recursion,
    respond,
    stack_structures,
    states_in_motion,
    structure_of_draw,
)
from reliab.assessment.rebuilt_error.sobol import normal_points
from reliab.assessment.rebuilt_error.spread import Spread, spread_of_draws
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.core.arrays import Array
from reliab.structures.partition import Partition
from reliab.structures.parts_of_structure import is_part

_STRUCTURE_QUANTITIES = ("frequency", "damping_ratio", "experimental_fraction", "feedback_lag")
_OPEN = ("open_offset", "open_drift", "open_filter")
_LAST = ("filter_delay", "hysteresis", "lagging_hysteresis", "sensor_drift", *_OPEN)
_FREEDOM = 4.0  # degrees of freedom of a deviation that is known by its order of magnitude
_START_ERROR_FACTOR = 1.4  # error at the first sample over what later ones show: it has the command's phase
_LEAST = 0.05  # of a stated value: a draw goes no lower
ACCURACY = 0.004  # of an error whose structure and channels are exact: 0.994 to 1.007 of the true one
_BAND_PERIOD_SHARE = 0.25  # of the period of the highest frequency of the motion that a step may be

EXACT_DRAWS = 64
"""Number of draws of the response that perfect actuators would have given."""

FEWEST_SWEPT = 4096
"""Number of samples up to which the motion's band, too, is resolved while draws are swept."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Swept:
    """Errors of the draws over a test so far, from which a later stretch of it can go on."""

    steps: int  # Number of steps between its samples
    statistics: Array  # Mean square of x_m − x_I [m²], its peak and that of x_I [m], shape (draws, 3, p)
    # mean, deviation: Of x_m − x_I over the draws at the swept samples of the last stretch [m], shape (p, m)
    mean: Array
    deviation: Array
    places: Array  # Of all samples of that stretch, numbered by those that were swept, shape (n,)
    states: Array  # States of the draws' structures at the last sample, shape (draws, 2n)
    nominal_states: tuple[Array, Array]  # The same as stated, by swept samples and by all, each shape (1, 2n)
    drawn: Mapping[str, Array]  # What was drawn by name, each shape (draws,)

    @cached_property
    def spreads(self) -> tuple[Spread, ...]:
        """RMS^R and MTE^R of the draws of each interface displacement."""
        rows = zip(np.moveaxis(self.statistics, 2, 0), self.mean, self.deviation, strict=True)
        return tuple(spread_of_draws(*row, self.places) for row in rows)

    @property
    def spread(self) -> Spread:
        """RMS^R and MTE^R of the draws, where there is one interface displacement."""
        (spread,) = self.spreads
        return spread

    def prepend_rest(self, steps: int) -> "Swept":
        """Errors of the same test with so many further steps of rest before it."""
        total_steps = self.steps + steps
        statistics = self.statistics.copy()
        statistics[:, 0] *= self.steps / total_steps
        return replace(self, steps=total_steps, statistics=statistics)

    def join(self, later: "Swept") -> "Swept":
        """Errors over this stretch and a later one of as many draws or fewer, which begins at its end."""
        steps, earlier = self.steps + later.steps, self.statistics[: len(later.statistics)]
        statistics = np.maximum(earlier, later.statistics)
        shares = self.steps / steps, later.steps / steps
        statistics[:, 0] = shares[0] * earlier[:, 0] + shares[1] * later.statistics[:, 0]
        return replace(later, steps=steps, statistics=statistics)


@dataclass(frozen=True, kw_only=True)
class StandardDeviations:
    """Standard deviations of everything that is uncertain, of a test with one sensor or with p of them."""

    tolerances: Tolerances  # Of what is stated
    # offset, error_at_start: Of the sensor offset that remains and of the error at the first sample, zero
    # where the test begins at rest [m]; of several sensors each shape (p,)
    offset: float | Array
    error_at_start: float | Array

    def deviations(self) -> dict[str, float]:
        """Return standard deviations by name, in the order of the draws; sensors have numbers if several."""
        sizes = dict(self.tolerances.items())
        # last and only where they are not zero, so that the draws of all others stay the same without them
        last = {name: sizes.pop(name) for name in _LAST}
        added = {**self._expand_sensors(last), **self.tolerances.of_parts}
        return self._expand_sensors({**sizes, "initial_state": 0.0}) | {k: v for k, v in added.items() if v}

    def _expand_sensors(self, sizes: Mapping[str, float]) -> dict[str, float]:
        """Give what each sensor has of its own as often as there are sensors."""
        has_sensors, deviations = np.ndim(self.offset) > 0, {}
        for name, value in sizes.items():
            if name in _STRUCTURE_QUANTITIES:
                deviations[name] = value
                continue
            sensor_deviation = {"sensor_offset": self.offset, "initial_state": self.error_at_start}.get(name)
            values = np.broadcast_to(
                value if sensor_deviation is None else np.hypot(value, sensor_deviation),
                np.shape(self.offset),
            )
            for place, size in enumerate(np.atleast_1d(values).tolist()):
                sensor_name = f"{name}_{place + 1}" if has_sensors else name
                deviations[sensor_name] = size + self.tolerances.of_sensors.get(sensor_name, 0.0)
        return deviations


EXACT = StandardDeviations(tolerances=Tolerances(), offset=0.0, error_at_start=0.0)
"""Nothing is uncertain but noise."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Histories:
    """Histories from which the error is rebuilt, without offsets of the sensors: of one actuator, or of p."""

    command: Array  # command, measured: x_c and the smoothed x_m at the sensors [m], shape (n,) or (p, n)
    measured: Array
    # x_c minus the displacement whose force was fed back, at the interface [m]: x_c − x_m unless it was late
    fed_back: Array
    time_step: float  # Step [s]
    # x_c − x_m at the interface [m] under which the structure stood still before the first sample
    standing: float | Array = 0.0
    # Interface displacements of unit displacements of the sensors [-], shape (p, p); None of one, which
    # stands there
    carry: Array | None = None
    smooth: bool = False  # Whether histories are smooth between samples; else they are straight lines

    def carry_to_interface(self, displacements: Array) -> Array:
        """Displacements of the interface by those at the sensors [m], shape (…, n)."""
        return displacements if self.carry is None else np.asarray(self.carry @ displacements)

    def carry_sensor(self, place: int, displacement: Array) -> Array:
        """Carry the displacement of one sensor, shape (…, n), to the interface [m], shape (…, p, n)."""
        row = displacement[..., np.newaxis, :]
        return row if self.carry is None else np.asarray(self.carry[:, place, np.newaxis] * row)

    @cached_property
    def difference(self) -> Array:
        """x_c − x_m at the interface [m], shape (n,) or (p, n)."""
        return self.carry_to_interface(self.command - self.measured)

    @property
    def late(self) -> Array:
        """What a force that was fed back late adds to x_c − x_m at the interface [m], shape (p, n)."""
        return np.atleast_2d(self.fed_back - self.difference)

    def thin(self, stride: int) -> "Histories":
        """Each `stride`-th sample."""
        return replace(
            self,
            command=np.ascontiguousarray(self.command[..., ::stride]),
            measured=np.ascontiguousarray(self.measured[..., ::stride]),
            fed_back=np.ascontiguousarray(self.fed_back[..., ::stride]),
            time_step=stride * self.time_step,
        )

    def recursion(self, structure: Partition) -> Recursion:
        """Recursion from x_c − x_m at these samples to the error of a structure, or of draws of it."""
        return Recursion.from_displacement(structure, self.time_step, smooth=self.smooth)

    def standing_in(self, recursion: Recursion) -> Array:
        """State in which the structure stood before the first sample, shape (2n,)."""
        return np.asarray(recursion.static @ np.atleast_1d(self.standing))

    def respond(self, recursion: Recursion) -> Array:
        """Answer e of the interface to the test as recorded [m], shape (p, n)."""
        return respond(recursion, self.fed_back, self.standing_in(recursion))


def sweep(
    histories: Histories,
    structure: Partition,
    unknown: StandardDeviations,
    differences: Array,
    stride: int,
    *,
    draws: int,
    seed: int,
    modes: int | None = None,
    numerical: Recursion | None = None,
    accuracy: float = 0.0,
    earlier: Swept | None = None,
) -> Swept:
    """Rebuild the error for draws of everything that is not known.

    `differences`: draws of x_c − x_m at the sensors, at each `stride`-th sample [m]; `modes`: number of the
    lowest ones that move, while others follow by statics, all by default; `numerical`: recursion of
    the ideal test as the computer steps it, exact by default; `accuracy` of an error whose structure is exact
    [-].
    """
    thin, base = histories.thin(stride), reduce_structure(structure, modes)
    values, moving = draw_unknown(unknown, draws, seed)
    structures = structures_of_draws(structure, values, modes)
    recursion = thin.recursion(structures).expand_draws(draws)
    coarse, fine = (thin.recursion(base), numerical or histories.recursion(base))
    if earlier is None:
        # draws of a reduced structure have shapes of their own
        states = _initial_states(thin, structure if modes is None else structures, recursion, values, moving)
        swept, stood = (histories.standing_in(grid)[np.newaxis] for grid in (coarse, fine))
    else:
        states = earlier.states[:draws].copy()
        swept, stood = (state.copy() for state in earlier.nominal_states)
    statistics, band = driven_draws(thin, recursion, values, states).errors(
        _carry_to_interface(thin, differences)
    )
    rough, exact = (_errors_as_stated(thin, coarse, swept), _errors_as_stated(histories, fine, stood))
    # what lies between the swept samples
    statistics *= np.divide(exact, rough, out=np.ones_like(rough), where=rough > 0.0)
    noise_factor = 1.0 + accuracy * np.random.default_rng(seed).standard_normal((draws, 1))
    statistics[:, 0] *= noise_factor**2
    statistics[:, 1] *= noise_factor
    mean, deviation = mean_and_deviation(band, draws)
    stretch = Swept(
        steps=histories.command.shape[-1] - 1,
        statistics=statistics,
        mean=mean,
        deviation=deviation,
        places=np.arange(histories.command.shape[-1]) / stride,
        states=states,
        nominal_states=(swept, stood),
        drawn=values,
    )
    return stretch if earlier is None else earlier.join(stretch)


def exact_of_draws(
    histories: Histories,
    structure: Partition,
    unknown: StandardDeviations,
    differences: Array,
    stride: int,
    *,
    seed: int,
    modes: int | None = None,
) -> Iterator[tuple[Partition, Array]]:
    """Structures, and responses without actuator errors at swept samples [m], shape (p, m), of first draws.

    Arguments as those of `sweep`.
    """
    thin = histories.thin(stride)
    quantities, moving = draw_unknown(unknown, EXACT_DRAWS, seed)
    structures = structures_of_draws(structure, quantities, modes)
    recursion = thin.recursion(structures).expand_draws(EXACT_DRAWS)
    states = _initial_states(thin, structure if modes is None else structures, recursion, quantities, moving)
    responses = driven_draws(thin, recursion, quantities, states).exact(
        _carry_to_interface(thin, differences)
    )
    full = structures if modes is None else structures_of_draws(structure, quantities)
    if full.size != structure.size:  # degrees without mass, which have no modes that could be off
        full = structures_of_draws(structure, {k: v for k, v in quantities.items() if not is_part(k)})
    for draw, response in enumerate(responses):
        yield structure_of_draw(full, draw), response


def _carry_to_interface(thin: Histories, differences: Array) -> Array:
    """Draws of x_c − x_m at the interface [m], shape (draws, p, m), by those at the sensors."""
    interface_differences = thin.carry_to_interface(differences)
    return interface_differences.reshape(len(interface_differences), -1, interface_differences.shape[-1])


def samples_in_step(structure_stride: int, noise: SensorNoise, samples: int) -> int:
    """Return the number of samples of which one is enough while draws are swept.

    `structure_stride`: the number of which one resolves the structure's modes.
    """
    band_stride = max(int(_BAND_PERIOD_SHARE / (noise.band * noise.time_step)), 1)
    return min(structure_stride, max(band_stride, -(-samples // FEWEST_SWEPT)))


def draw_unknown(unknown: StandardDeviations, draws: int, seed: int) -> tuple[dict[str, Array], Array]:
    """Draw what is unknown, each shape (draws,), and errors of the velocity at the first sample.

    The latter over the lowest natural frequency in rad/s [m], shape (draws,) or (draws, p).
    """
    deviations, sensors = unknown.deviations(), np.size(unknown.offset)
    points = normal_points(len(deviations) + sensors, draws, seed)
    start_points = _start_points(points[-sensors:].T.reshape(draws, *np.shape(unknown.offset)))
    quantities = {
        name: deviations[name] * (_start_points(row) if name.startswith("initial") else row)
        for name, row in zip(deviations, points[:-sensors], strict=True)
    }
    for name, values in quantities.items():
        if name == "damping_ratio" or (is_part(name) and "damping" in name):
            quantities[name] = relative_ratios(values, deviations[name])
        elif name.startswith("lagging_hysteresis"):
            quantities[name] = np.maximum(values, 0.0)
        elif name.startswith(_OPEN):
            quantities[name] = np.where(values > 0.0, deviations[name], 0.0)
    return quantities, start_points * unknown.error_at_start


def relative_ratios(drawn: Array, deviation: float) -> Array:
    """Damping ratios over the stated one, less one: the normal draws as logarithms of larger tails.

    A damping ratio is known by a factor, and its deviation to a third of itself: Student's t with four
    degrees of freedom (JCGM 100:2008, G.4.2).
    """
    return np.asarray(np.expm1(deviation * _student_points(drawn / deviation))) if deviation else drawn


def _start_points(points: Array) -> Array:
    """Turn standard normal points into errors at the first sample over their deviation."""
    return _START_ERROR_FACTOR * _student_points(points)


def _student_points(points: Array) -> Array:
    """Turn standard normal points into Student's t with few degrees of freedom."""
    return np.asarray(scipy.special.stdtrit(_FREEDOM, scipy.special.ndtr(points)))


def _errors_as_stated(histories: Histories, recursion: Recursion, state: Array) -> Array:
    """Statistics with nothing drawn, shape (3, p); the state, shape (1, 2n), moves to the last sample."""
    driven = driven_draws(histories, recursion.expand_draws(1), {"feedback_lag": np.zeros(1)}, state)
    return np.asarray(driven.errors(np.atleast_2d(histories.difference)[np.newaxis])[0][0])


def _initial_states(
    thin: Histories, structure: Partition, recursion: Recursion, drawn: Mapping[str, Array], moving: Array
) -> Array:
    """States of draws of a test at its first sample, shape (draws, 2n)."""
    displaced = np.stack([row for name, row in drawn.items() if name.startswith("initial_state")], axis=1)
    return np.ascontiguousarray(
        states_at_first_sample(structure, recursion, displaced, moving, thin.standing)
    )


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
        return np.asarray(still + _states_along_interface(structure, displaced, moving))
    each = (
        _states_along_interface(structure_of_draw(structure, draw), displaced[draw], moving[draw])
        for draw in range(draws)
    )
    return np.asarray(still + np.stack(list(each)))


def _states_along_interface(structure: Partition, displaced: Array, moving: Array) -> Array:
    """States of a structure that is displaced and moves as its interface does, shape (…, 2n)."""
    w0 = 2.0 * np.pi * float(structure.natural_frequencies[0])
    by_displacement, by_velocity = states_in_motion(structure, structure.shapes_of_interface)
    return np.asarray(displaced @ by_displacement.T + w0 * moving @ by_velocity.T)


def inputs_of_reading(thin: Histories, drawn: Mapping[str, Array]) -> tuple[Array, Array]:
    """Columns of what is drawn of the one sensor, shape (columns, n), and how much each draw has of them."""
    return columns_of_sensor(thin.command, thin.measured, thin.time_step, drawn)


def _inputs_of_sensors(thin: Histories, drawn: Mapping[str, Array]) -> tuple[Array, Array]:
    """Columns of what is drawn of all sensors, at the interface, shape (columns, p, n), and the same."""
    inputs, sizes = [], []
    for place, rows in enumerate(zip(np.atleast_2d(thin.command), np.atleast_2d(thin.measured), strict=True)):
        number = "" if thin.carry is None else f"_{place + 1}"
        columns, shifts = columns_of_sensor(*rows, thin.time_step, drawn, number)
        inputs.append(thin.carry_sensor(place, columns))
        sizes.append(shifts)
    return np.concatenate(inputs), np.concatenate(sizes, axis=1)


def columns_of_sensor(
    command: Array, measured_displacement: Array, step: float, drawn: Mapping[str, Array], number: str = ""
) -> tuple[Array, Array]:
    """Columns that a unit of what is drawn of a sensor adds to x_c − x_m, and how much each draw has of them.

    `command`, `measured_displacement` [m], shape (n,); `step` [s]; `number` ends the names of one of several
    sensors.
    Returns shapes (columns, n) and (draws, columns).
    """
    rate = np.gradient(measured_displacement, step)
    place = np.linspace(-0.5, 0.5, rate.size)
    stride = {
        "sensor_scale": measured_displacement,
        "time_shift": rate,
        "sensor_offset": np.ones(rate.size),
        "filter_delay": rate,
        "sensor_drift": place,
        "open_offset": np.ones(rate.size),
        "open_drift": place,
        "open_filter": -rate,
    }
    columns = {f"{name}{number}": column for name, column in stride.items()}
    for name in {f"hysteresis{number}", f"lagging_hysteresis{number}"} & drawn.keys():
        columns[name] = -lag_of_reading(command, float(np.std(drawn[name])))
    names = [name for name in columns if name in drawn and drawn[name].any()]
    draws = next(iter(drawn.values())).size
    inputs = np.array([columns[name] for name in names]).reshape(-1, rate.size)
    return inputs, np.array([drawn[name] for name in names]).reshape(-1, draws).T.copy()


def driven_draws(
    thin: Histories, recursion: Recursion, drawn: Mapping[str, Array], states: Array
) -> DrivenDraws:
    """Collect what drives the draws of a test."""
    inputs, shifts = _inputs_of_sensors(thin, drawn)
    return DrivenDraws(
        recursion=recursion,
        states=states,
        command=np.atleast_2d(thin.carry_to_interface(thin.command)),
        inputs=inputs,
        shifts=shifts,
        late=thin.late,
        velocity=np.atleast_2d(thin.carry_to_interface(np.gradient(thin.measured, thin.time_step, axis=-1))),
        lags=drawn["feedback_lag"],
    )


def _factors_of_draws(drawn: Mapping[str, Array]) -> list[Array]:
    """Factors of frequencies, damping ratios and the specimen's share, each shape (draws,)."""
    draws = next(iter(drawn.values())).size
    names = ("frequency", "damping_ratio", "experimental_fraction")
    f, ratio, share = (np.maximum(1.0 + drawn.get(name, np.zeros(draws)), _LEAST) for name in names)
    # a damping matrix that is stated does not change with the frequency
    return [f, ratio / f if "damping" in drawn else ratio, share]


def reduce_structure(structure: Partition, modes: int | None) -> Partition:
    """Structure of which so many of the lowest modes move, or all, and others follow by statics."""
    return structure if modes is None else structure.reduce_to_modes(modes)


def structures_of_draws(
    structure: Partition, drawn: Mapping[str, Array], modes: int | None = None
) -> Partition:
    """Structures of the draws, as one whose matrices have a first axis of draws where they differ."""
    f, ratio, share = _factors_of_draws(drawn)
    parts = {name: values for name, values in drawn.items() if is_part(name)}
    if parts:
        changed = [
            structure.change_parts({name: float(values[draw]) for name, values in parts.items()})
            for draw in range(f.size)
        ]
        structure = stack_structures([reduce_structure(one, modes) for one in changed])
    else:
        structure = reduce_structure(structure, modes)
    if not (np.concatenate([f, ratio, share]) != 1.0).any():
        return structure
    return structure.scale(frequency=f, damping_ratio=ratio, share=share)
