"""The natural frequency that a test shows of its own structure, without its ground acceleration.

The response without actuator errors follows from the test, x_I = x_c − e, and with it the ground acceleration
that was felt ::

    a = −(x_I'' + 2ξω₀x_I' + ω₀²x_I)

With another frequency than that of the structure this is wrong by the ratio of two resonances: it has a
peak at one of them and a notch at the other, and stays where the ground rests and the structure vibrates
freely. The spectrum of a ground motion has neither. Coefficients of a over time and frequency are taken as
normal, with a variance whose logarithm is a broken line in time and a parabola in the logarithm of frequency,
fitted for each frequency that is tried (Whittle's likelihood, of displacements: Whittle 1953, Arkiv för
Matematik 2, 423).

Real ground motions have peaks of their own. The likelihood therefore counts by half. Under real records and
for structures of 0.4 to 2.5 Hz and 2 to 8 %, the frequency then has a standard deviation of about 2.3 %;
together with a stated one of 2 %, the 90 % interval held it in 92 to 94 of 100 tests. The stated deviation
is taken as known to a third of itself: Student's t with four degrees of freedom (JCGM 100:2008, G.4.2).

An entry of a matrix that is a few per cent off moves the lowest frequency as far as a whole stiffness does. A
test shows its frequency, and with it which of the drawn entries its structure had.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from reliab.assessment.rebuilt_error.error_statistics import relative_errors
from reliab.assessment.rebuilt_error.kernel import Kernel
from reliab.assessment.rebuilt_error.recursion import Recursion, respond
from reliab.assessment.rebuilt_error.sobol import normal_points
from reliab.core.arrays import Array
from reliab.signals.cubic_path import CubicPath
from reliab.signals.lapped_transform import analyse
from reliab.structures.partition import Partition
from reliab.structures.parts_of_structure import is_of_entries

_DRAWS = 64

_SAMPLES_PER_PERIOD = 48.0  # samples in a period
_PERIODS_OF_HOP = 4.0
_FEWEST_PERIODS = 10.0
_LOWEST, _HIGHEST = 1.0 / 3.0, 3.0  # of the stated frequency: band in which ground motions are looked at
_NEXT_FREQUENCY_SHARE = 0.75  # of the next natural frequency that the band reaches
_FRAMES_BETWEEN = 2.0  # points of the broken line
_REACH, _LARGEST = 5.0, 0.25  # offsets that are tried: in standard deviations, and of the frequency at most
_FREQUENCY_COUNT = 31
_FINE = 401
_COUNTS = 0.5  # of the likelihood
_FREEDOM = 4.0  # degrees of freedom of the stated deviation
_PARTS = 16  # of a coefficient's band over which the resonance is averaged
_LEFT_OPEN = float(np.exp(-2.0))  # of the largest density: two standard deviations either way
_GOVERNING_DRAWS = 2  # of sixteen draws
_CONTRADICTS = 6.63  # twice the log of a likelihood ratio: one in a hundred by chance
_RIDGE, _CURVATURE, _TOLERANCE, _STEPS = 1e-3, 0.3, 1e-4, 30


@dataclass(frozen=True, kw_only=True, eq=False)
class EntriesOfStructure:
    """Uncertain entries of M and K, with the structure they belong to."""

    structure: Partition  # As stated
    deviations: Mapping[str, float]  # Of the entries by name, relative [-]

    @classmethod
    def from_parts(cls, structure: Partition, deviations: Mapping[str, float]) -> "EntriesOfStructure | None":
        """Collect those that move frequencies; None where there are none."""
        moving = {
            name: deviation
            for name, deviation in deviations.items()
            if is_of_entries(name) and not name.startswith("damping") and deviation
        }
        return cls(structure=structure, deviations=moving) if moving else None

    @cached_property
    def deviation(self) -> float:
        """Standard deviation of the lowest frequency that they leave open, relative [-]."""
        points = normal_points(len(self.deviations), _DRAWS, seed=0)
        entries = {
            name: row * self.deviations[name] for name, row in zip(self.deviations, points, strict=True)
        }
        return float(np.std(self._factors(entries)))

    def match_frequencies(self, quantities: Mapping[str, Array]) -> dict[str, Array]:
        """Give each draw the entries whose lowest frequency is nearest to its own.

        `quantities`: quantities by name, shape (draws,), with "frequency", of which what no entries explain
        remains.
        """
        factors = self._factors(quantities)
        order = np.argsort(factors)
        factors_of_draws = 1.0 + quantities["frequency"]
        middles = 0.5 * (factors[order][1:] + factors[order][:-1])
        places = order[np.searchsorted(middles, factors_of_draws)]
        entries = {name: quantities[name][places] for name in self.deviations}
        return {**quantities, **entries, "frequency": factors_of_draws / factors[places] - 1.0}

    def _factors(self, quantities: Mapping[str, Array]) -> Array:
        """Lowest natural frequency of each draw, over the stated one [-], shape (draws,)."""
        draws = zip(*(quantities[name].tolist() for name in self.deviations), strict=True)
        structures = (
            self.structure.change_parts(dict(zip(self.deviations, values, strict=True))) for values in draws
        )
        lowest = np.array([structure.natural_frequencies[0] for structure in structures])
        return np.asarray(lowest / self.structure.natural_frequencies[0])


@dataclass(frozen=True, kw_only=True, eq=False)
class OwnFrequency:
    """What a test shows of its natural frequency: relative offsets from the stated one, and their likelihood.

    >>> offsets = np.linspace(-0.1, 0.1, 41)
    >>> shown = OwnFrequency(
    ...     offsets=offsets,
    ...     likelihood=-0.5 * (offsets / 0.01 - 3.0) ** 2,
    ...     errors=0.03 - offsets**2,
    ...     stated_deviation=0.02,
    ... )
    >>> round(shown.value, 3), round(shown.deviation, 3), shown.contradicts
    (0.025, 0.009, True)
    """

    offsets: Array  # Of the natural frequency from the stated one, relative, ascending [-]
    likelihood: Array  # Logarithm of the likelihood of each [-]
    errors: Array  # RMS^R with each of them [-]
    stated_deviation: float  # Standard deviation of the stated frequency, relative [-]
    entries: EntriesOfStructure | None = None  # Entries of matrices that say how far it may be off

    def offsets_at_points(self, points: Array) -> Array:
        """Give offsets at standard normal points, by quantiles of what test and statement say.

        Two draws of sixteen have the governing offset: any other frequency than that at which the recording
        moves makes the computed error too small.
        """
        offsets, density = self._density
        places = np.append(0.0, np.cumsum(np.diff(offsets) * (density[1:] + density[:-1]) / 2.0))
        quantiles = np.interp(scipy.special.ndtr(points), places / places[-1], offsets)
        return np.where(np.arange(points.size) % 16 < _GOVERNING_DRAWS, self.governing, quantiles)

    @cached_property
    def governing(self) -> float:
        """Offset that makes the error largest, of those that test and statement leave open [-]."""
        offsets, density = self._density
        errors = CubicPath.interpolate(self.offsets, self.errors)(offsets)
        return float(offsets[np.argmax(np.where(density > _LEFT_OPEN, errors, 0.0))])

    @cached_property
    def value(self) -> float:
        """Mean of the offset by test and statement [-]."""
        offsets, density = self._density
        return float(np.trapezoid(density * offsets, offsets) / np.trapezoid(density, offsets))

    @cached_property
    def deviation(self) -> float:
        """Standard deviation of the offset [-]."""
        offsets, density = self._density
        square = np.trapezoid(density * (offsets - self.value) ** 2, offsets)
        return float(np.sqrt(square / np.trapezoid(density, offsets)))

    @property
    def contradicts(self) -> bool:
        """Whether the test alone contradicts the stated frequency, by one chance in a hundred."""
        stated_likelihood = float(np.interp(0.0, self.offsets, self.likelihood))
        return bool(2.0 * (self.likelihood.max() - stated_likelihood) > _CONTRADICTS)

    @cached_property
    def _density(self) -> tuple[Array, Array]:
        fine = np.linspace(self.offsets[0], self.offsets[-1], _FINE)
        likelihood = CubicPath.interpolate(self.offsets, self.likelihood)(fine)
        penalty = 0.5 * (_FREEDOM + 1.0) * np.log1p((fine / self.stated_deviation) ** 2 / _FREEDOM)
        logarithm = likelihood - penalty
        return fine, np.asarray(np.exp(logarithm - logarithm.max()))


def learn_frequency(
    command: Array,
    fed_back: Array,
    difference: Array,
    time_step: float,
    structure: Partition,
    deviation: float,
    *,
    standing: Array,
    smooth: bool = False,
    entries: EntriesOfStructure | None = None,
) -> OwnFrequency | None:
    """Learn the natural frequency from a test; None where it is exact or the test is short.

    `command`, `fed_back` and x_c − x_m, the `difference`, at the interface [m], shape (p, n); `time_step`
    [s]; `deviation` of the stated frequency, relative; `standing` x_c − x_m before the test [m], shape (p,);
    `smooth`: whether histories are smooth between samples; `entries` that leave the frequency open, too. Of
    several displacements the one shows it whose motion in the lowest mode strains the specimen most.
    """
    if entries is not None:
        deviation = float(np.hypot(deviation, entries.deviation))
    if not deviation:
        return None
    frequencies, _, interface_shapes = structure.modes
    place = int(np.argmax(np.diag(structure.specimen_stiffness) * interface_shapes[:, 0] ** 2))
    stride = samples_to_learn(command.shape[1], time_step, float(frequencies[0]))
    if stride is None:
        return None
    step = stride * time_step
    short, drive, thin_difference = (
        np.ascontiguousarray(history[:, ::stride]) for history in (command, fed_back, difference)
    )

    def responses(factors: Array) -> Iterator[tuple[Array, Array]]:
        structures = structure.scale(frequency=factors)
        recursions = Recursion.from_displacement(structures, step, smooth=smooth)
        for draw in range(factors.size):
            recursion = recursions.select_draw(draw)
            moving = respond(recursion, drive, recursion.static @ standing)[place]
            yield short[place] - moving, moving - thin_difference[place]

    trials = FrequencyTrials(
        time_step=step, frequencies=frequencies, first_mode=_lowest(structure), responses=responses
    )
    return replace(trials.learn(deviation), entries=entries)


def samples_to_learn(samples: int, time_step: float, lowest: float) -> int | None:
    """Say of how many samples one is enough to learn a frequency; None where the test is too short."""
    if not samples * time_step * lowest > _FEWEST_PERIODS:
        return None
    return max(int(1.0 / (_SAMPLES_PER_PERIOD * lowest * time_step)), 1)


@dataclass(frozen=True, kw_only=True, eq=False)
class FrequencyTrials:
    """What is needed to compute the ground acceleration that was felt, for any frequency."""

    time_step: float  # s
    frequencies: Array  # Natural frequencies as stated, ascending [Hz]
    first_mode: tuple[float, float]  # ω₀ [rad/s] and 2ξω₀ [1/s]
    # Gives the response without actuator errors and the error [m], each shape (n,), for factors of all
    # frequencies
    responses: Callable[[Array], Iterator[tuple[Array, Array]]]

    def learn(self, deviation: float) -> OwnFrequency:
        """Learn the natural frequency beside a stated one of a relative standard deviation."""
        offsets = np.linspace(-1.0, 1.0, _FREQUENCY_COUNT) * min(_REACH * deviation, _LARGEST)
        likelihood, errors = self._likelihood_of_factors(1.0 + offsets)
        return OwnFrequency(
            offsets=offsets, likelihood=_COUNTS * likelihood, errors=errors, stated_deviation=deviation
        )

    def _likelihood_of_factors(self, factors: Array) -> tuple[Array, Array]:
        """Logarithm of the likelihood of each factor of the frequencies, and RMS^R with it."""
        frequencies = self.frequencies
        lowest = float(frequencies[0])
        kernel = Kernel.from_frequency(lowest, self.time_step)
        step = kernel.every * self.time_step
        hop = 2 * round(0.5 * _PERIODS_OF_HOP / (lowest * step))
        places = (np.arange(hop) + 0.5) / (2.0 * hop * step)
        highest = min([_HIGHEST * lowest, *(_NEXT_FREQUENCY_SHARE * frequencies[1:2])])
        band = (places > _LOWEST * lowest) & (places < highest)
        gain = _gain(kernel, places[band])
        parts = places[band, np.newaxis] + ((np.arange(_PARTS) + 0.5) / _PARTS - 0.5) / (2.0 * hop * step)
        answer, errors, fit = np.empty(factors.size), np.empty(factors.size), None
        for place, (response, error) in enumerate(self.responses(factors)):
            w0, twice = (factors[place] * value for value in self.first_mode)
            ground = analyse(kernel.sum_seen(response, (w0**2, twice, 1.0)), hop)[:, band]
            squares = (ground / gain) ** 2
            fit = fit or _VariancesFit(squares, places[band] / lowest)
            answer[place] = fit.likelihood(squares) + 0.5 * len(ground) * _resonance(w0, twice, parts)
            errors[place], _ = relative_errors(error, response)
        return answer, errors


def _resonance(w0: float, twice: float, frequency: Array) -> float:
    """Sum over bands of the mean of ln |ω₀² − ω² + 2iξω₀ω|² at their frequencies [Hz], (bands, parts)."""
    circular_frequency = 2.0 * np.pi * frequency
    return float(
        np.log((w0**2 - circular_frequency**2) ** 2 + (twice * circular_frequency) ** 2).mean(axis=1).sum()
    )


def _lowest(structure: Partition) -> tuple[float, float]:
    """ω₀ [rad/s] and 2ξω₀ [1/s] of the lowest mode."""
    shape = structure.first_mode
    mass, damping, stiffness = (
        float(shape @ matrix @ shape) for matrix in (structure.mass, structure.damping, structure.stiffness)
    )
    return float(np.sqrt(stiffness / mass)), damping / mass


def _gain(kernel: Kernel, frequency: Array) -> Array:
    """Gain of the kernel at frequencies [Hz]."""
    values = kernel.values[0]
    time = (np.arange(values.size) - values.size // 2) * kernel.time_step
    return np.asarray(np.cos(2.0 * np.pi * frequency[:, np.newaxis] * time) @ values)


class _VariancesFit:
    """Variances that are a broken line in time and a parabola in ln frequency, fitted to squares."""

    def __init__(self, squares: Array, frequency: Array) -> None:
        self._scale = float(squares.mean())
        self._design = _design(len(squares), np.log(frequency))
        self._found: Array = np.asarray(
            np.linalg.lstsq(self._design, self._logarithms(squares), rcond=None)[0], dtype=np.float64
        )

    def _logarithms(self, squares: Array) -> Array:
        return np.asarray(np.log(squares.ravel() / self._scale + _RIDGE))

    def likelihood(self, squares: Array) -> float:
        """Largest logarithm of the likelihood −½ Σ (ln v + c²/v), by Newton's method."""
        design, half, scaled_squares = self._design, 0.5 * self._design.T, squares.ravel() / self._scale
        penalty = _RIDGE * np.eye(len(half))

        def cost(coefficients: Array) -> tuple[float, Array]:
            """Cost of coefficients, and c²/v with them."""
            level = design @ coefficients
            ratio = scaled_squares * np.exp(-level)
            return 0.5 * float(np.sum(level + ratio) + _RIDGE * (coefficients @ coefficients)), ratio

        least, ratio = cost(self._found)
        for _ in range(_STEPS):
            slope = half @ (1.0 - ratio) + _RIDGE * self._found
            step = np.linalg.solve((half * np.maximum(ratio, _CURVATURE)) @ design + penalty, slope)
            while (candidate := cost(self._found - step))[0] > least and np.abs(step).max() > _TOLERANCE:
                step /= 2.0
            if least - candidate[0] < _TOLERANCE:
                break
            self._found, (least, ratio) = self._found - step, candidate
        return -least


def _design(frames: int, logarithm: Array) -> Array:
    """Columns of ln v: hats over time, and ln f, its square and its change over time."""
    points = np.linspace(0.0, frames - 1.0, max(round(frames / _FRAMES_BETWEEN), 1) + 1)
    time = np.arange(float(frames))
    hats = np.maximum(1.0 - np.abs(time[:, np.newaxis] - points) / (points[1] - points[0]), 0.0)
    time_columns = np.stack([np.ones(frames), np.ones(frames), np.linspace(-1.0, 1.0, frames)], axis=1)
    frequency_columns = np.stack([logarithm, logarithm**2, logarithm], axis=1)
    columns = [
        *(np.repeat(hat, logarithm.size) for hat in hats.T),
        *(np.outer(t, f).ravel() for t, f in zip(time_columns.T, frequency_columns.T, strict=True)),
    ]
    return np.stack(columns, axis=1)
