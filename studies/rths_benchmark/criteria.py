"""The nine criteria of the virtual hybrid-simulation benchmark, in the order of its code.

The paper of the benchmark numbers J5 to J7 differently (its J5 is J6 here, its J6 is J7 and its J7 is J5).
"""

from typing import Final

import numpy as np

from reliab.arrays import Array
from reliab.simulation.laboratory import Run

NAMES: Final = tuple(f"J{number}" for number in range(1, 10))

_LONGEST_LAG = 50  # samples


def tracking_delay(command: Array, measured: Array, step: float) -> float:
    """Lag [s], from 0 to 49 samples, at which measured and command displacement correlate best.

    `command`, `measured`: displacements [m], shape (n,); `step`: step [s].

    >>> late = np.sin(0.01 * np.arange(1000))
    >>> tracking_delay(np.sin(0.01 * (np.arange(1000) + 7)), late, 1.0)
    7.0
    """
    size = command.size
    correlations = [
        np.corrcoef(command[: size - lag], measured[lag:])[0, 1] for lag in range(min(_LONGEST_LAG, size - 2))
    ]
    return float(np.argmax(correlations)) * step


def benchmark_criteria(run: Run) -> dict[str, float]:
    """J1 [ms] and J2 to J9 [%] of a test whose first three degrees of freedom are floors."""
    measured, numerical, reference = run.measured, run.floors, run.reference

    def spread(values: Array, reference: Array) -> float:
        return 100.0 * float(np.std(values, ddof=1) / np.std(reference, ddof=1))

    def peak(values: Array, reference: Array) -> float:
        return 100.0 * float(np.abs(values).max() / np.abs(reference).max())

    tracking = measured - numerical[0]
    first = measured - reference[0]
    second, third = numerical[1] - reference[1], numerical[2] - reference[2]
    values = [
        spread(tracking, numerical[0]),
        peak(tracking, numerical[0]),
        spread(first, reference[0]),
        peak(first, reference[0]),
        spread(second, reference[1]),
        spread(third, reference[2]),
        peak(second, reference[1]),
        peak(third, reference[2]),
    ]
    delay = round(1e3 * tracking_delay(numerical[0], measured, run.step), 1)
    return dict(zip(NAMES, [delay, *(round(value, 2) for value in values)], strict=True))
