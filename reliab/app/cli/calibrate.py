"""`reliab calibrate`: what the two displacement channels add to a motion."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.app.cli.demand import argument, option, takes
from reliab.app.cli.options import JSON_TARGET, ReadsTests
from reliab.app.cli.output import console, say, table, write_json
from reliab.core.significant_digits import significant

if TYPE_CHECKING:
    from reliab.core.stated_value import StatedValue
    from reliab.recordings.calibration import ChannelCalibration


@dataclass(frozen=True, kw_only=True)
class CalibrateDemand(ReadsTests):
    """Options of `reliab calibrate`, arguments of `reliab.calibrate`."""

    test: Path = argument(
        "FILE",
        "Test in which both channels record one motion: a sine, a sweep, or steps with pauses, "
        "without a specimen.",
    )
    out: Path | None = option("CHANNELS.toml", "File for --channels of the commands that read tests.")
    actuator_delay: str | None = option(
        "MS", "Delay of the actuator in this test [ms], 12±0.5; 0 where both channels record one signal."
    )
    json_target: str | None = JSON_TARGET


@takes(CalibrateDemand)
def calibrate(demand: CalibrateDemand) -> None:
    """Measure skew, scale, hysteresis, noise and resolution of the two displacement channels."""
    from reliab.app.api.records import calibrate as api_calibrate

    calibration = demand.ask(api_calibrate, "json_target")
    if not write_json(calibration.to_dict(), demand.json_target):
        _show(calibration)
        say(*(f"Note: {demand.in_options(note)}" for note in calibration.notes))


def _show(calibration: "ChannelCalibration") -> None:
    shown = table(
        "What the measured channel adds to the motion", {"": "left", "value": "right", "± 1 sd": "right"}
    )
    for name, quantity in (
        ("delay behind the command's channel [ms]", calibration.skew_ms),
        ("scale relative to the command's channel [-]", calibration.scale),
        ("hysteresis over the range of the motion [-]", calibration.hysteresis),
    ):
        shown.add_row(name, *_cells(quantity))
    for name, metres in (
        ("noise of the measured channel, RMS [m]", calibration.noise_m),
        ("noise of the command's channel, RMS [m]", calibration.command_noise_m),
        ("step between readings [m]", calibration.resolution_m),
    ):
        shown.add_row(name, significant(metres) if metres else "0", "")
    console().print(shown)


def _cells(quantity: "StatedValue | None") -> tuple[str, str]:
    if quantity is None:
        return "not determined", ""
    return f"{quantity.value:.5g}", significant(quantity.deviation)
