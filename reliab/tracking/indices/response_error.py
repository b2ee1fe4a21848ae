"""Error of the whole test: how far the measured displacement is from the exact response.

Both are normalised by the **peak** of the exact response, which is what reproduces the published
numbers::

    RMS^R = √(mean (x_m − x_I)²) / max|x_I|        MTE^R = max|x_m − x_I| / max|x_I|

The mean is taken over a window of time; over the whole record, without free vibration after it, RMS^R
falls with the record's length as about 1/√T.
"""

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.simulation.excitation import Deviation, peak_of_history


def relative_error(deviation: Deviation, metric: Metric) -> Array:
    """RMS^R or MTE^R of many simulated tests.

    `deviation`: statistics of x_m − x_I over the window. Returns the error [-], shape (cells,). Raises
    InputError if the exact response is zero throughout.
    """
    if not deviation.ideal_peak > 0.0:
        raise InputError(
            "The exact response is zero throughout",
            value=f"a peak of {deviation.ideal_peak} m",
            remedy="Check that the ground motion is not zero inside the window",
        )
    size = np.sqrt(deviation.mean_square) if metric is Metric.RMS else deviation.peak
    return size / deviation.ideal_peak


def response_error(measured_displacement: Array, ideal: Array, metric: Metric = Metric.RMS) -> float:
    """RMS^R or MTE^R of one test from its histories.

    `measured_displacement`, `ideal` [m]; returns [-].

    >>> phase = np.linspace(0.0, 20.0 * np.pi, 2001)
    >>> round(response_error(1.01 * np.sin(phase), np.sin(phase)), 5)
    0.00707
    """
    difference = measured_displacement - ideal
    deviation = Deviation(
        mean_square=np.array([np.trapezoid(difference**2) / (difference.size - 1)]),
        peak=np.array([peak_of_history(difference)]),
        ideal_peak=peak_of_history(ideal),
    )
    return float(relative_error(deviation, metric)[0])
