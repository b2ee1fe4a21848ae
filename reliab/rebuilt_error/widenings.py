"""Which of the things that are not known widens the interval of a rebuilt error most."""

from dataclasses import dataclass, replace

import numpy as np

from reliab.rebuilt_error.interval import LEVEL, Histories, Unknown, combine, sweep
from reliab.rebuilt_error.noise_share import NoiseShare
from reliab.rebuilt_error.whole_structure import WholeStructure


@dataclass(frozen=True, kw_only=True)
class Widening:
    """What one thing that is not known does to the interval.

    Attributes
    ----------
    name : str
        The tolerance, or "sensor_noise" or "initial_state".
    deviation : float
        Its standard deviation, relative or in SI units; zero for noise.
    width : float
        Width of the 90 % interval [-].
    width_without : float
        Width if this were known exactly [-].
    deviation_for_half : float or None
        Standard deviation at which the width is halved; None where no value does so alone.
    """

    name: str
    deviation: float
    width: float
    width_without: float
    deviation_for_half: float | None


def widenings(
    histories: Histories,
    structure: WholeStructure,
    unknown: Unknown,
    share: NoiseShare,
    *,
    rms: bool,
    draws: int,
    seed: int,
) -> tuple[Widening, ...]:
    """Which unknowns widen the interval most, and what would halve it.

    Parameters
    ----------
    histories, structure, unknown, share
        As for `sweep` and `combine`.
    rms : bool
        Whether the interval is that of RMS^R, else of MTE^R.
    draws, seed : int
        Number and seed of the draws.

    Returns
    -------
    tuple of Widening
        The widest first; only what widens the interval.
    """

    def width(changed: Unknown, noisy: NoiseShare) -> float:
        drawn = combine(sweep(histories, structure, changed, draws, seed), noisy, seed)
        ends = np.quantile(drawn.rms if rms else drawn.mte, [0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL])
        return float(ends[1] - ends[0])

    whole = width(unknown, share)
    parts = []
    for name, deviation in unknown.deviations().items():
        if deviation > 0.0:
            without = width(_scaled(unknown, name, 0.0), share)
            half = None
            if without < 0.5 * whole:
                low, high = 0.0, 1.0
                for _ in range(6):
                    middle = 0.5 * (low + high)
                    narrow = width(_scaled(unknown, name, middle), share) <= 0.5 * whole
                    low, high = (middle, high) if narrow else (low, middle)
                half = low * deviation or None
            parts.append(
                Widening(
                    name=name,
                    deviation=deviation,
                    width=whole,
                    width_without=without,
                    deviation_for_half=half,
                )
            )
    if share.deviation > 0.0:
        quiet = replace(share, in_square=np.zeros(1), in_peak=np.zeros(1))
        without = width(unknown, quiet)
        parts.append(
            Widening(
                name="sensor_noise",
                deviation=0.0,
                width=whole,
                width_without=without,
                deviation_for_half=None,
            )
        )
    return tuple(
        sorted((part for part in parts if part.width_without < whole), key=lambda part: part.width_without)
    )


def _scaled(unknown: Unknown, name: str, factor: float) -> Unknown:
    if name == "initial_state":
        return replace(unknown, error_at_start=factor * unknown.error_at_start)
    tolerances = replace(unknown.tolerances, **{name: factor * getattr(unknown.tolerances, name)})
    offset = factor * unknown.offset if name == "sensor_offset" else unknown.offset
    return replace(unknown, tolerances=tolerances, offset=offset)
