"""The names of dimensions, variables, metrics, blocks and effects, with their units.

Every other module takes them from here; nothing else in the package spells one out.
"""

from enum import StrEnum

STANDARD_GRAVITY = 9.80665
"""Standard gravity [m/s²], by definition."""


class Dimension(StrEnum):
    """Dimensions of a results dataset, in storage order."""

    MOTION = "motion"
    FREQUENCY = "f"
    DAMPING_RATIO = "xi"
    GAIN = "kp"
    DELAY = "tau"


class Metric(StrEnum):
    """Relative error of the whole test: root mean square and maximum."""

    RMS = "rms"
    MTE = "mte"


class Block(StrEnum):
    """Part of the loop in which an effect acts."""

    ACTUATOR = "actuator"
    SENSOR = "sensor"
    SPECIMEN = "specimen"
    EXCITATION = "excitation"
    NUMERICAL = "numerical"
