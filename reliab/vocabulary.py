"""The names of dimensions, variables, metrics, blocks and effects, with their units.

Every other module takes them from here; nothing else in the package spells one out.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

STANDARD_GRAVITY: Final = 9.80665
"""Standard gravity [m/s²], by definition."""


class Dimension(StrEnum):
    """Dimensions of a results dataset in storage order, and those that ellipses add."""

    MOTION = "motion"
    FREQUENCY = "f"
    DAMPING_RATIO = "xi"
    GAIN = "kp"
    DELAY = "tau"
    THRESHOLD = "threshold"
    METRIC = "metric"
    CURVE = "curve"


RESULT_DIMENSIONS: Final = (
    Dimension.MOTION,
    Dimension.FREQUENCY,
    Dimension.DAMPING_RATIO,
    Dimension.GAIN,
    Dimension.DELAY,
)
ELLIPSE_DIMENSIONS: Final = (
    Dimension.MOTION,
    Dimension.FREQUENCY,
    Dimension.DAMPING_RATIO,
    Dimension.THRESHOLD,
    Dimension.METRIC,
    Dimension.CURVE,
)


class Metric(StrEnum):
    """Relative error of the whole test: root mean square and maximum."""

    RMS = "rms"
    MTE = "mte"


@dataclass(frozen=True)
class Label:
    """What a variable or coordinate is called in full, and its unit."""

    long_name: str
    units: str


LABELS: Final = {
    "rms": Label("RMS^R: RMS of measured minus exact displacement over peak exact displacement", "1"),
    "mte": Label("MTE^R: peak of measured minus exact displacement over peak exact displacement", "1"),
    "A": Label("amplitude of the frequency-domain evaluation index", "1"),
    "d": Label("equivalent delay of the frequency-domain evaluation index", "s"),
    "stable": Label("delay below the critical delay", "1"),
    "motion": Label("ground-motion component", "1"),
    "f": Label("natural frequency of the structure", "Hz"),
    "xi": Label("damping ratio of the structure", "1"),
    "kp": Label("actuator gain", "1"),
    "tau": Label("actuator delay", "s"),
    "event": Label("earthquake", "1"),
    "duration": Label("duration of the record", "s"),
    "dt": Label("time step of the record", "s"),
    "pga": Label("peak ground acceleration", "m s-2"),
    "checksum": Label("SHA-256 of the record's time step and samples", "1"),
    "threshold": Label("error on the boundary", "1"),
    "metric": Label("relative error of the whole test", "1"),
    "curve": Label("curve fitted to the boundary", "1"),
    "a": Label("ellipse parameter of the amplitude, (A − 1)²/a + d²/b = 1", "1"),
    "b": Label("ellipse parameter of the delay, (A − 1)²/a + d²/b = 1", "ms2"),
    "sse": Label("fitting error, sum of squared differences of squared delays", "ms4"),
    "n": Label("points of the boundary", "1"),
}


class Block(StrEnum):
    """Part of the loop in which an effect acts."""

    ACTUATOR = "actuator"
    SENSOR = "sensor"
    SPECIMEN = "specimen"
    EXCITATION = "excitation"
    NUMERICAL = "numerical"


class EffectName(StrEnum):
    """Effects that the workbench knows; the first two are calibration, not missing effects."""

    GAIN_ERROR = "gain_error"
    DELAY_ERROR = "delay_error"
    FIRST_ORDER_LAG = "first_order_lag"
    SECOND_ORDER_DYNAMICS = "second_order_dynamics"
    DELAY_DRIFT = "delay_drift"
    RATE_LIMIT = "rate_limit"
    STROKE_SATURATION = "stroke_saturation"
    BACKLASH = "backlash"
    SENSOR_BIAS = "sensor_bias"
    SENSOR_DRIFT = "sensor_drift"
    FORCE_BIAS = "force_bias"
    CUBIC_STIFFNESS = "cubic_stiffness"
    QUADRATIC_STIFFNESS = "quadratic_stiffness"
    COULOMB_FRICTION = "coulomb_friction"
    VISCOUS_DAMPING = "viscous_damping"
    QUADRATIC_DAMPING = "quadratic_damping"
    HYSTERESIS = "hysteresis"
    ADDED_MASS = "added_mass"
    GAP = "gap"
    EXCITATION_SCALE = "excitation_scale"
    TIME_STEP_ERROR = "time_step_error"
    INTEGRATION_ERROR = "integration_error"
