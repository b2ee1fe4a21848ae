"""The names of dimensions, variables, metrics and blocks, with their units.

Every other module takes them from here; nothing else in the package spells one out.
"""

from dataclasses import dataclass
from enum import IntEnum, StrEnum
from typing import Final

from reliab.core.errors import InputError

STANDARD_GRAVITY: Final = 9.80665
"""Standard gravity [m/s²], by definition."""

PERCENT: Final = 100.0
"""Hundredths in one."""

MILLI: Final = 1e3
"""Thousandths in one: milliseconds in a second, millimetres in a metre."""


class Dimension(StrEnum):
    """Dimensions of a results dataset in storage order, and those that ellipses add.

    A dataset has the dimension of the share α where it is of several shares, after that of the damping ratio;
    of one share it is an attribute (see `reliab.sweep.labels`).
    """

    MOTION = "motion"
    FREQUENCY = "f"
    DAMPING_RATIO = "xi"
    SHARE = "alpha"
    GAIN = "kp"
    DELAY = "tau"
    THRESHOLD = "threshold"
    METRIC = "metric"
    CURVE = "curve"
    SIDE = "side"
    WINDOW = "window"


SHARE_ATTRIBUTE: Final = "experimental_fraction"
"""Attribute of a dataset of one share of the stiffness in the laboratory."""

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
    Dimension.SIDE,
)


class Metric(StrEnum):
    """Relative error of the whole test: root mean square and maximum."""

    RMS = "rms"
    MTE = "mte"

    @classmethod
    def parse(cls, name: str) -> "Metric":
        """Return the error of a name.

        >>> Metric.parse("mte").name
        'MTE'
        """
        if name not in list(cls):
            raise InputError("The metric is rms or mte", value=name, remedy="Choose one of these")
        return cls(name)


ERROR_NAMES: Final = {Metric.RMS: "RMS error", Metric.MTE: "largest error"}
"""The errors of a test in sentences."""


class Side(StrEnum):
    """Side of a boundary: an actuator that is late (d ≥ 0) or early (d < 0)."""

    LAG = "lag"
    LEAD = "lead"

    @property
    def sign(self) -> float:
        """Sign of the delays on this side."""
        return 1.0 if self is Side.LAG else -1.0


class CurveName(StrEnum):
    """Curves that stand for a boundary.

    The ellipse is the paper's, fitted by least squares (equation 9); the inscribed one is the largest
    ellipse that lies wholly inside the boundary.
    """

    ELLIPSE = "ellipse"
    INSCRIBED = "inscribed"


class NoEllipse(IntEnum):
    """Why a boundary has no ellipse; its a and b are then NaN, or zero where there is no room."""

    NOT_SO = 0
    """There is an ellipse."""
    NO_ROOM = 1
    """The loop's other effects alone exceed the threshold."""
    OUTSIDE_GRID = 2
    """The boundary leaves the stored grid."""
    NOT_REACHED = 3
    """No delay on this side reaches the threshold."""
    NOT_ELLIPTIC = 4
    """The least-squares line of equation (9) does not fall, so that a or b is not positive."""


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
    "alpha": Label("share of the stiffness in the laboratory", "1"),
    "kp": Label("actuator gain", "1"),
    "tau": Label("actuator delay, negative for a lead", "s"),
    "event": Label("earthquake", "1"),
    "duration": Label("duration of the record", "s"),
    "dt": Label("time step of the record", "s"),
    "pga": Label("peak ground acceleration", "m s-2"),
    "checksum": Label("SHA-256 of the record's time step and samples", "1"),
    "outline": Label("strongest swing of the record in 256 bits, by which copies are recognised", "1"),
    "threshold": Label("error on the boundary", "1"),
    "metric": Label("relative error of the whole test", "1"),
    "curve": Label("curve that stands for the boundary", "1"),
    "side": Label("side of the boundary: actuator late (lag) or early (lead)", "1"),
    "window": Label("stretch of the record over which the error is taken: record, arias or seconds", "1"),
    "a": Label("ellipse parameter of the amplitude, (A − 1)²/a + d²/b = 1", "1"),
    "b": Label("ellipse parameter of the delay, (A − 1)²/a + d²/b = 1", "ms2"),
    "length": Label("length to which records are cut", "s"),
    "a_cut": Label("a of a cut record over that of the whole record", "1"),
    "b_cut": Label("b of a cut record over that of the whole record", "1"),
    "sse": Label("fitting error, sum of squared differences of squared delays", "ms4"),
    "n": Label("points of the boundary", "1"),
    "no_ellipse": Label("why there is no ellipse, 0 where there is one", "1"),
    "rms_at_rest": Label("RMS^R of an actuator that does not move", "1"),
    "error_at_rest": Label("error of the whole test with an actuator that does not move", "1"),
}


class Block(StrEnum):
    """Part of the loop in which an effect acts."""

    ACTUATOR = "actuator"
    SENSOR = "sensor"
    SPECIMEN = "specimen"
    EXCITATION = "excitation"
    NUMERICAL = "numerical"
