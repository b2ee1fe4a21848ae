"""The criteria J1 to J10 of the multi-axial benchmark, as its code computes them."""

from typing import Any, Final

import numpy as np
import scipy

from reliab.arrays import Array

from .loop import MultiAxialRun
from .structure import RATE, to_node

NAMES: Final = tuple(f"J{number}" for number in range(1, 11))


def tracking_delay(target: Array, measured: Array) -> float:
    """Lag [ms] at which the two histories correlate best, negative where the measured one leads.

    >>> target = np.sin(0.01 * np.arange(3000)) * np.exp(-((np.arange(3000) - 1500.0) / 400.0) ** 2)
    >>> round(tracking_delay(target[5:], target[:-5]) * RATE / 1e3, 6)
    5.0
    """
    correlation = np.abs(scipy.signal.correlate(measured, target, method="fft"))
    return float(np.argmax(correlation) - (target.size - 1)) / RATE * 1e3


def spread(difference: Array, base: Array) -> float:
    """Return the standard deviation of a difference over that of its base [%]."""
    return 100.0 * float(np.std(difference, ddof=1) / np.std(base, ddof=1))


def peak(difference: Array, base: Array) -> float:
    """Largest difference over the largest value of its base [%]."""
    return 100.0 * float(np.abs(difference).max() / np.abs(base).max())


def criteria(run: MultiAxialRun, reference: Array) -> dict[str, Any]:
    """J1 [ms] and J2 to J10 [%] of a test; `reference` as `loop.reference` gives it.

    J1 to J3 by actuator, J5 to J7 and J9 for x and θ of the node, J8 and J10 for x and θ of storeys 2 and 3.
    J4 is J1, as the benchmark's code has it.
    """
    error = run.measured - run.target
    node = to_node(run.measured)
    node[1] *= -1.0
    numerical, undivided = run.numerical[[0, 3]], reference[[0, 3]]
    above = [1, 4, 2, 5]
    delays = [tracking_delay(*pair) for pair in zip(run.target, run.measured, strict=True)]
    strayed = run.numerical[above] - reference[above]
    return {
        "J1": delays,
        "J2": _of_each(spread, error, run.target),
        "J3": _of_each(peak, error, run.target),
        "J4": delays,
        "J5": _of_each(spread, node - numerical, numerical),
        "J6": _of_each(peak, node - numerical, numerical),
        "J7": _of_each(spread, node - undivided, undivided),
        "J8": _of_each(spread, strayed, reference[above]),
        "J9": _of_each(peak, node - undivided, undivided),
        "J10": _of_each(peak, strayed, reference[above]),
    }


def _of_each(measure: Any, differences: Array, bases: Array) -> list[float]:  # noqa: ANN401
    return [measure(difference, base) for difference, base in zip(differences, bases, strict=True)]
