"""Which uncertain quantity widens the interval of a rebuilt error most.

The square of an error is a quadratic form in what is drawn. Its dependence on each quantity is fitted to the
draws themselves, y = y₀ + Σ aᵢuᵢ + bᵢuᵢ² by least squares, and gives the error as it would be if one of them
were known better.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from reliab.assessment.rebuilt_error.spread import Spread
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.structures.parts_of_structure import is_part

_HALVINGS = 12


@dataclass(frozen=True, kw_only=True)
class Widening:
    """Effect of one uncertain quantity on the interval."""

    name: str  # The tolerance, or "sensor_noise" or "initial_state"
    deviation: float  # Its standard deviation, relative or in SI units; zero for noise
    contribution: float  # Standard deviation of the error that it alone causes [-]
    width: float  # Width of the 90 % interval [-]
    width_without: float  # Width if this were known exactly [-]
    # Standard deviation at which the width is halved; None where no value does so alone
    deviation_for_half: float | None


def widenings(
    spread: Spread,
    quantities: Mapping[str, Array],
    deviations: Mapping[str, float],
    noise_spread: Spread,
    metric: Metric,
) -> tuple[Widening, ...]:
    """Find what each uncertain quantity contributes, the largest first, and what would halve the interval.

    `quantities`: quantities by name, shape (draws,); `noise_spread`: draws with all but the sensors' noise as
    stated.
    """
    parts = widenings_of_draws(spread, quantities, deviations, metric)
    parts.append(widening_alone("sensor_noise", spread, noise_spread, metric))
    return tuple(sorted(parts, key=lambda part: -part.contribution))


def widenings_of_draws(
    spread: Spread, quantities: Mapping[str, Array], deviations: Mapping[str, float], metric: Metric
) -> list[Widening]:
    """Find what each quantity contributes to draws; those that are not drawn contribute nothing."""
    effects = _effects(spread.errors(metric) ** 2, {name: u for name, u in quantities.items() if u.any()})
    return [_widening(effect, spread, metric, deviations[name]) for name, effect in effects.items()]


def widening_alone(
    name: str, spread: Spread, single_spread: Spread, metric: Metric, deviation: float = 0.0
) -> Widening:
    """Say what a quantity contributes of which there are draws that hold nothing else.

    Without it the interval is taken to be as much narrower as its share of the variance says.
    """
    contribution, total_deviation = (float(np.std(draws.errors(metric))) for draws in (single_spread, spread))
    remainder = max(1.0 - (contribution / total_deviation) ** 2, 0.0) if total_deviation > 0.0 else 0.0
    full_width = _width(spread, metric)
    return Widening(
        name=name,
        deviation=deviation,
        contribution=contribution,
        width=full_width,
        width_without=full_width * float(np.sqrt(remainder)),
        deviation_for_half=None,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _SquareEffect:
    """What one quantity adds to the squares of the errors, a u + b u² alone and u Σ cᵢuᵢ with others."""

    name: str
    linear: Array  # a u, shape (draws,)
    square: Array  # b u², shape (draws,)
    joint: Array  # u Σ cᵢuᵢ with what sensors of other actuators have alike, shape (draws,)
    nominal: float  # y₀, the square of the error with everything as stated

    def change(self, factor: float) -> Array:
        """Return what it would add if it were known better by a factor."""
        return factor * (self.linear + self.joint) + factor**2 * self.square


def _effects(squares: Array, quantities: dict[str, Array]) -> dict[str, _SquareEffect]:
    normalized = {name: values / np.std(values) for name, values in quantities.items()}
    pairs = _alike_at_sensors(normalized)
    products = [normalized[first] * normalized[second] for first, second in pairs]
    terms = [*normalized.values(), *(values**2 for values in normalized.values()), *products]
    columns = np.stack([np.ones_like(squares), *terms])
    coefficients = np.linalg.lstsq(columns.T, squares, rcond=None)[0]
    rows = coefficients[:, np.newaxis] * columns
    joint = list(zip(pairs, rows[1 + 2 * len(quantities) :], strict=True))
    return {
        name: _SquareEffect(
            name=name,
            linear=rows[1 + k],
            square=rows[1 + len(quantities) + k],
            joint=np.sum([np.zeros_like(squares), *(row for pair, row in joint if name in pair)], axis=0),
            nominal=float(coefficients[0]),
        )
        for k, name in enumerate(quantities)
    }


def _alike_at_sensors(names: Iterable[str]) -> list[tuple[str, str]]:
    """Pairs of what sensors of several actuators have alike: a rotation feels the difference of two."""
    stems = {name: name.rstrip("_0123456789") for name in names if not is_part(name)}
    return [(first, second) for first, second in combinations(stems, 2) if stems[first] == stems[second]]


def _widening(effect: _SquareEffect, spread: Spread, metric: Metric, deviation: float) -> Widening:
    squares = spread.errors(metric) ** 2
    weighted_spread = replace(
        spread, counts=spread.weights()
    )  # a draw whose error vanishes would count for all

    def width(factor: float) -> float:
        errors = np.sqrt(np.maximum(squares - effect.change(1.0) + effect.change(factor), 0.0))
        return _width(replace(weighted_spread, **{metric.value: errors}), metric)

    full_width, narrow_width = _width(spread, metric), width(0.0)
    single_errors = np.sqrt(np.maximum(effect.nominal + effect.linear + effect.square, 0.0))
    return Widening(
        name=effect.name,
        deviation=deviation,
        contribution=float(np.std(single_errors)),
        width=full_width,
        width_without=narrow_width,
        deviation_for_half=_deviation_for_half(deviation, 0.5 * full_width, width)
        if narrow_width < 0.5 * full_width
        else None,
    )


def _width(spread: Spread, metric: Metric) -> float:
    low, high = spread.interval(metric)
    return high - low


def _deviation_for_half(deviation: float, half: float, width: Callable[[float], float]) -> float | None:
    """Find the standard deviation at which the interval is half as wide, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        narrow = width(middle) <= half
        low, high = (middle, high) if narrow else (low, middle)
    return low * deviation or None
