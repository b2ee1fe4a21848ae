"""How long a test may be: the draws of its error are held in memory at once."""

from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.structures.partition import Partition

LARGEST_DRAW_SIZE = 1_000_000
"""Largest number of samples at which a history is drawn; 256 draws then take about 5 GB with their copies."""

_SWEPT_SAMPLES_PER_PERIOD = 64.0  # samples in a period of the highest mode while draws are swept
_LEAST_RATE = 200.0  # samples in a second, and in a period, where the test is simulated anew
_SIMULATED_PER_PERIOD = 80.0
_HOUR = 3600.0


def samples_in_step_of_structure(structure: Partition, time_step: float) -> int:
    """Return the number of samples of which one resolves the highest mode.

    `time_step` [s].
    Returns at least one; tests so long that their size matters are drawn at each such sample.
    """
    return max(
        int(1.0 / (_SWEPT_SAMPLES_PER_PERIOD * float(structure.natural_frequencies[-1]) * time_step)), 1
    )


def samples_in_step_of_simulation(
    frequency: float,
    time_step: float,
    *,
    least_rate: float = _LEAST_RATE,
    samples_per_period: float = _SIMULATED_PER_PERIOD,
) -> int:
    """Return the number of samples of which one is simulated anew, at least one.

    `frequency`: the lowest natural frequency [Hz]; `time_step` [s]; `least_rate` [Hz].
    """
    return max(int(1.0 / (time_step * max(least_rate, samples_per_period * frequency))), 1)


def require_fitting(samples: int, stride: int, time_step: float) -> None:
    """Refuse a test whose draws would not fit in memory, before they are made.

    `time_step` [s].

    >>> require_fitting(24 * 3600 * 256, 4, 1.0 / 256.0)
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: A test of this structure may last 4.34 h at most, since the intervals of
    its error are drawn at 1,000,000 samples at most; found 24 h. Cut it where everything stands still, and
    judge the parts one by one.
    """
    if -(-samples // stride) > LARGEST_DRAW_SIZE:
        longest = LARGEST_DRAW_SIZE * stride * time_step / _HOUR
        raise InputError(
            f"A test of this structure may last {significant(longest)} h at most, since the intervals of "
            f"its error are drawn at {LARGEST_DRAW_SIZE:,} samples at most",
            value=f"{significant(samples * time_step / _HOUR)} h",
            remedy="Cut it where everything stands still, and judge the parts one by one",
        )
