"""The paper's example: KOBE/NIS000 at 1 Hz and 2 % damping, Figures 2 to 10 and Table 1.

One ground motion, the actuator's gain and delay varied: histories, errors against delay and against
amplitude, both at once, and the contours of equal error with the curves fitted to them.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import brentq

from reliab.core.vocabulary import Metric
from reliab.motions.motion import Motion
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import spectral
from reliab.structures.structure import Structure, critical_delay
from reliab.tracking.boundary.contour import Contour
from reliab.tracking.boundary.suite_boundary import motion_contours
from reliab.tracking.indices.response_error import relative_error

from .printed import (
    AMPLITUDES,
    DELAYS_OF_FIGURE_4,
    DELAYS_OF_FIGURE_8,
    FIVE_PERCENT,
    ONE_HERTZ,
    SHOWN_TESTS,
    TWO_PERCENT,
)

_SLACK: Final = 1e-6  # of a step, by which the end of a contour may lie beyond it
_METRICS: Final = (Metric.MTE, Metric.RMS)


def run_paper_example(
    motion: Motion, *, frequency: float = ONE_HERTZ, damping_ratio: float = TWO_PERCENT
) -> xr.Dataset:
    """Simulate the example.

    `frequency`, `damping_ratio`: the structure [Hz, -]. Result: `displacement` [m] over (test, time) with the
    coordinates `test_gain` and `test_delay`, the first test being the exact response; `error_of_delay` over
    (metric, long_delay) at gain 1, `error_of_gain` over (metric, gain) without delay, and `error` over
    (metric, gain, delay) [-]; `amplitude_mte`, `delay_mte`, `amplitude_rms` and `delay_rms`, the contours of
    5 % error [-] and [s] over their points, with `ends_mte` and `ends_rms` [-] over end ("low", "high"), the
    amplitudes at which they reach d = 0. Attributes: `critical_delay` [s], `motion`, `f`, `xi`.
    """
    structure = Structure(frequency=frequency, damping_ratio=damping_ratio)
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    loop = Loop(excitation=excitation, structure=structure)
    variables = {**_histories(excitation, structure), **_errors(loop), **_contours(loop)}
    coordinates = {
        "metric": [str(metric) for metric in _METRICS],
        "gain": AMPLITUDES,
        "delay": DELAYS_OF_FIGURE_8,
    }
    coordinates["end"] = ["low", "high"]
    attributes = {
        "critical_delay": float(critical_delay(structure)),
        "motion": motion.name,
        "f": frequency,
        "xi": damping_ratio,
    }
    example = xr.Dataset(
        variables, coords={**coordinates, "long_delay": DELAYS_OF_FIGURE_4}, attrs=attributes
    )
    gains, delays = zip(*SHOWN_TESTS, strict=True)
    return example.assign_coords(test_gain=("test", list(gains)), test_delay=("test", list(delays)))


def _histories(excitation: Excitation, structure: Structure) -> dict[str, tuple[Sequence[str], object]]:
    histories = [spectral.response(excitation, structure, gain, delay) for gain, delay in SHOWN_TESTS]
    step = histories[0][1]
    displacement = np.stack([history for history, _ in histories])
    times = excitation.window[0] + step * np.arange(displacement.shape[1])
    return {"displacement": (("test", "time"), displacement), "time": (("time",), times)}


def _errors(loop: Loop) -> dict[str, tuple[Sequence[str], object]]:
    gain, delay = np.meshgrid(AMPLITUDES, DELAYS_OF_FIGURE_8, indexing="ij")
    both = _relative(loop, gain, delay).reshape(len(_METRICS), *gain.shape)
    return {
        "error_of_delay": (
            ("metric", "long_delay"),
            _relative(loop, np.ones_like(DELAYS_OF_FIGURE_4), DELAYS_OF_FIGURE_4),
        ),
        "error_of_gain": (("metric", "gain"), _relative(loop, AMPLITUDES, np.zeros_like(AMPLITUDES))),
        "error": (("metric", "gain", "delay"), both),
    }


def _relative(loop: Loop, gain: NDArray[np.float64], delay: NDArray[np.float64]) -> NDArray[np.float64]:
    """Errors of actuators [-], shape (metrics, cells)."""
    deviation = loop.deviation(loop.cells(gain=gain, delay=delay))
    return np.stack([relative_error(deviation, metric) for metric in _METRICS])


def _contours(loop: Loop) -> dict[str, tuple[Sequence[str], object]]:
    variables: dict[str, tuple[Sequence[str], object]] = {}
    for metric in _METRICS:
        (contour,) = motion_contours(loop, (FIVE_PERCENT,), metric)
        point = (f"point_{metric}",)
        variables |= {
            f"amplitude_{metric}": (point, contour.amplitude),
            f"delay_{metric}": (point, contour.delay),
            f"ends_{metric}": (("end",), _ends(loop, contour, metric)),
        }
    return variables


def _ends(loop: Loop, contour: Contour, metric: Metric) -> NDArray[np.float64]:
    """Amplitudes below and above 1 at which the contour reaches the axis d = 0, shape (2,)."""

    def excess(amplitude: float) -> float:
        cells = loop.cells(gain=np.array([amplitude]), delay=np.zeros(1))
        return float(relative_error(loop.deviation(cells), metric)[0]) - FIVE_PERCENT

    steps = np.diff(contour.amplitude)[[0, -1]] * (-1.0, 1.0)
    outermost = contour.amplitude[[0, -1]]
    return np.array(
        [
            brentq(excess, inside, inside + (1.0 + _SLACK) * step)
            for inside, step in zip(outermost.tolist(), steps.tolist(), strict=True)
        ]
    )
