"""`reliab calibrate`: what the two displacement channels add to a motion."""

from typing import TYPE_CHECKING

from reliab.app import questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import say, show_table
from reliab.core.significant_digits import decimals_of_uncertainty, significant
from reliab.core.vocabulary import MILLI

if TYPE_CHECKING:
    from reliab.core.stated_value import StatedValue
    from reliab.recordings.calibration import ChannelCalibration

_UNDETERMINED = 10.0  # times the value: a deviation from which nothing is known of it


@takes(questions.CalibrationQuestion, questions.CalibrationFile)
def calibrate(request: Request) -> None:
    """Measure skew, scale, hysteresis, noise and resolution of the two displacement channels."""
    from reliab.app.api.records import calibrate as api_calibrate

    request.answer(api_calibrate, _show)


def _show(calibration: "ChannelCalibration") -> None:
    quantities = {
        "delay behind the command's channel [ms]": calibration.skew_ms,
        "scale relative to the command's channel [-]": calibration.scale,
        "hysteresis over the range of the motion [-]": calibration.hysteresis,
    }
    lengths = {
        "noise of the measured channel, RMS [mm]": calibration.noise_m,
        "noise of the command's channel, RMS [mm]": calibration.command_noise_m,
        "step between readings [mm]": calibration.resolution_m,
    }
    show_table(
        "What the measured channel adds to the motion",
        {"": "left", "value": "right", "± 1 sd": "right"},
        [(name, *_cells(quantity)) for name, quantity in quantities.items()]
        + [
            (name, significant(MILLI * length, 2) if length else "none", "")
            for name, length in lengths.items()
        ],
    )
    say(*(f"Note: {note}" for note in calibration.notes))


def _cells(quantity: "StatedValue | None") -> tuple[str, str]:
    if quantity is None or quantity.deviation > _UNDETERMINED * abs(quantity.value):
        return "not determined", ""
    decimals = decimals_of_uncertainty(quantity.deviation)
    return f"{quantity.value:.{decimals}f}", f"{quantity.deviation:.{decimals}f}"
