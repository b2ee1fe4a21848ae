"""Which uncertain quantity widens the interval of a rebuilt error most."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.interval import Histories, Unknown, sweep
from reliab.assessment.rebuilt_error.whole_structure import WholeStructure
from reliab.vocabulary import Metric

_HALVINGS = 6


@dataclass(frozen=True, kw_only=True)
class Widening:
    """Effect of one uncertain quantity on the interval."""

    name: str  # The tolerance, or "sensor_noise" or "initial_state"
    deviation: float  # Its standard deviation, relative or in SI units; zero for noise
    width: float  # Width of the 90 % interval [-]
    width_without: float  # Width if this were known exactly [-]
    # Standard deviation at which the width is halved; None where no value does so alone
    deviation_for_half: float | None


def widenings(
    histories: Histories,
    structure: WholeStructure,
    unknown: Unknown,
    differences: Array,
    every: int,
    *,
    metric: Metric,
    draws: int,
    seed: int,
) -> tuple[Widening, ...]:
    """Find which uncertain quantities widen the interval most, and what would halve it."""

    def width(changed: Unknown, drawn: Array = differences) -> float:
        swept = sweep(histories, structure, changed, drawn, every, draws=draws, seed=seed)
        low, high = swept.spread.interval(metric)
        return high - low

    whole = width(unknown)
    parts = [
        Widening(
            name=name,
            deviation=deviation,
            width=whole,
            width_without=(without := width(_scaled(unknown, name, 0.0))),
            deviation_for_half=_for_half(unknown, name, deviation, 0.5 * whole, width)
            if without < 0.5 * whole
            else None,
        )
        for name, deviation in unknown.deviations().items()
        if deviation > 0.0
    ]
    quiet = width(unknown, differences.mean(axis=0, keepdims=True))
    parts.append(
        Widening(
            name="sensor_noise", deviation=0.0, width=whole, width_without=quiet, deviation_for_half=None
        )
    )
    return tuple(
        sorted((part for part in parts if part.width_without < whole), key=lambda part: part.width_without)
    )


def _for_half(
    unknown: Unknown, name: str, deviation: float, half: float, width: Callable[[Unknown], float]
) -> float | None:
    """Find the standard deviation at which the interval is half as wide, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        narrow = width(_scaled(unknown, name, middle)) <= half
        low, high = (middle, high) if narrow else (low, middle)
    return low * deviation or None


def _scaled(unknown: Unknown, name: str, factor: float) -> Unknown:
    if name == "initial_state":
        return replace(unknown, error_at_start=factor * unknown.error_at_start)
    tolerances = replace(unknown.tolerances, **{name: factor * getattr(unknown.tolerances, name)})
    offset = factor * unknown.offset if name == "sensor_offset" else unknown.offset
    return replace(unknown, tolerances=tolerances, offset=offset)
