"""What limits the use of results."""

from collections.abc import Sequence

from reliab.report.document import Points, Section
from reliab.report.prose import Prose, prose
from reliab.report.wording import listed, percent
from reliab.validation import HARDENING, measured_yielding


def limits_section(sentences: Sequence[Prose]) -> Section:
    """List what limits the use of the results."""
    always = (
        prose(
            "The structure has one degree of freedom and stays linear; other systems are not covered. "
            + _yielding()
        ),
        prose(
            "A criterion looks at $A$ and $d$ alone. An actuator whose gain and delay change during the "
            "test, friction, backlash or noise can cause errors that they do not show."
        ),
    )
    return Section(title="Limits", blocks=(Points(items=(*sentences, *always)),), label="sec:limits")


def _yielding() -> str:
    """Say what was measured on specimens that yield."""
    measured = measured_yielding()
    shares = listed(
        [
            f"{percent(measurement.exceeding, 2)} of {measurement.tests} tests at $R = "
            f"{measurement.reduction:g}$ (up to "
            f"{measurement.largest_ratio:.1f} times)"
            for measurement in measured
        ]
    )
    return (
        "A specimen that yields is not always less demanding: with an actuator at which the linear structure "
        f"just reaches the error, the error of an elastoplastic one ({percent(HARDENING)} hardening) is "
        "larger "
        f"in {shares}, $R$ being the peak of the linear response over the yield displacement, under "
        f"{measured[0].motions} real motions."
    )
