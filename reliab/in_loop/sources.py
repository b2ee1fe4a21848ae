"""The monitor in C: templates that do not change, and one header with the numbers of a structure.

The recursion is the one of `reliab.assessment.rebuilt_error`, exact for a straight line between samples; its
coefficients are written with 17 digits, so that both compute with the same numbers.
"""

from dataclasses import dataclass
from importlib.resources import files

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error import (
    CALM,
    FALSE_ALARMS,
    FOLLOWS,
    INDEPENDENT,
    LARGE_MOTION,
    LARGEST_PLAY,
    LOOKS,
    MEMORY,
    SHRINKS,
    Damping,
    Recursion,
    WholeStructure,
    delayed,
    equilibrium,
)
from reliab.errors import InputError
from reliab.recordings import LARGEST_READING
from reliab.significant import significant
from reliab.vocabulary import Metric

TEMPLATES = ("reliab_monitor.h", "reliab_monitor.c", "example.c", "README.md")
CONFIGURATION = "reliab_monitor_config.h"
MOST_DEGREES_OF_FREEDOM = 100

_LARGEST_DRIFT = 1e-5  # m that the command moves from its first value while the sensor's offset is learned
_STUCK = 1e-3  # m of the command while the measured value repeats
_FEWEST_PER_PERIOD = 10.0


@dataclass(frozen=True, kw_only=True)
class LoopMonitor:
    """What a monitor in a loop is made for.

    Raises InputError where the rate is too low for the structure, or the structure too large.
    """

    structure: WholeStructure  # The whole structure, specimen included
    time_step: float  # Step of the loop [s]
    feedback_lag: float = 0.0  # Time by which the force is fed back late [s]
    sensor_scale: float = 1.0  # Scale of the displacement sensor [-]
    threshold: float = 0.05  # Largest error of a good test [-]
    metric: Metric = Metric.RMS

    def __post_init__(self) -> None:
        if self.structure.interface.size > MOST_DEGREES_OF_FREEDOM:
            raise InputError(
                f"A monitor in a loop has {MOST_DEGREES_OF_FREEDOM} degrees of freedom at most",
                value=self.structure.interface.size,
                remedy="Condense the structure",
            )
        samples = 1.0 / (float(self.structure.natural_frequencies[0]) * self.time_step)
        if samples < _FEWEST_PER_PERIOD:
            raise InputError(
                f"A period of the structure must hold at least {_FEWEST_PER_PERIOD:.0f} samples",
                value=significant(samples),
                remedy="Run the monitor at the rate of the loop",
            )


def monitor_sources(monitor: LoopMonitor) -> dict[str, str]:
    """Return the files of a monitor in C by name."""
    folder = files("reliab.in_loop").joinpath("template")
    texts = {name: folder.joinpath(name).read_text(encoding="utf-8") for name in TEMPLATES}
    return {**texts, CONFIGURATION: _configuration(monitor)}


def _configuration(monitor: LoopMonitor) -> str:
    return "\n".join(
        [
            "/* The structure, rate and threshold of this monitor; written, not edited. */",
            "#ifndef RELIAB_MONITOR_CONFIG_H",
            "#define RELIAB_MONITOR_CONFIG_H",
            *(f"#define RELIAB_{name} {value}" for name, value in _numbers(monitor).items()),
            "#endif",
            "#if defined(RELIAB_COEFFICIENTS) && !defined(RELIAB_COEFFICIENTS_WRITTEN)",
            "#define RELIAB_COEFFICIENTS_WRITTEN",
            *_coefficients(monitor),
            "#endif",
            "",
        ]
    )


def _numbers(monitor: LoopMonitor) -> dict[str, str]:
    """Return what the monitor is made for, and what its alarms need."""
    structure, step = monitor.structure, monitor.time_step
    damping = Damping.of_structure(structure, step)
    period = 1.0 / float(structure.natural_frequencies[0])
    real = {
        "STEP": step,
        "SENSOR_SCALE": monitor.sensor_scale,
        "THRESHOLD": monitor.threshold,
        "FORGETTING": damping.forgetting,
        "DAMPING_RATIO": damping.ratio,
        "DAMPING_FACTOR": damping.factor,
        "SAMPLES_IN_PERIOD": damping.samples,
        "CIRCULAR_FREQUENCY": damping.circular_frequency,
        "MEMORY": MEMORY,
        "INDEPENDENT": INDEPENDENT,
        "FALSE_ALARMS": FALSE_ALARMS,
        "FOLLOWS": FOLLOWS,
        "LARGE_MOTION": LARGE_MOTION,
        "LARGEST_PLAY": LARGEST_PLAY,
        "CALM": CALM,
        "SHRINKS": SHRINKS,
        "LARGEST_READING": LARGEST_READING,
        "REST_M": _LARGEST_DRIFT,
        "STUCK_M": _STUCK,
    }
    whole = {
        "ORDER": 2 * structure.interface.size,
        "LAG_STEPS": int(monitor.feedback_lag / step),
        "LOOK": max(round(period / (LOOKS * step)), 1),
    }
    return {
        **{name: f"{value}u" for name, value in whole.items()},
        "METRIC_IS_RMS": str(int(monitor.metric is Metric.RMS)),
        **{name: _real(value) for name, value in real.items()},
    }


def _coefficients(monitor: LoopMonitor) -> list[str]:
    """Return the arrays of the recursion."""
    recursion = Recursion.of_displacement(monitor.structure, monitor.time_step)
    rows = ",\n    ".join(_row(row) for row in recursion.decay)
    vectors = {
        "EARLY": recursion.early,
        "LATE": recursion.late,
        "OUTPUT": recursion.output[0],
        "EQUILIBRIUM": equilibrium(monitor.structure, 1.0),
        "LAG_WEIGHTS": _weights(monitor),
    }
    return [
        f"static const double DECAY[RELIAB_ORDER][RELIAB_ORDER] = {{\n    {rows}}};",
        *(f"static const double {name}[{value.size}] = {_row(value)};" for name, value in vectors.items()),
        f"static const double FEED_THROUGH = {_real(float(recursion.feed_through[0]))};",
    ]


def _weights(monitor: LoopMonitor) -> Array:
    """Return weights of the displacements so many steps ago, and one, two and three more; shape (4,)."""
    whole = int(monitor.feedback_lag / monitor.time_step)
    impulse = np.zeros(2 * whole + 16)
    impulse[whole + 8] = 1.0
    late = delayed(impulse, monitor.feedback_lag, monitor.time_step)
    return np.asarray(late[2 * whole + 8 : 2 * whole + 12])


def _row(values: Array) -> str:
    return "{" + ", ".join(_real(float(value)) for value in values) + "}"


def _real(value: float) -> str:
    """Write a double so that reading gives the same bits."""
    text = f"{value:.17g}"
    return text if any(mark in text for mark in ".en") else f"{text}.0"
