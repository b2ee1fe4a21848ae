"""`reliab.calibrate`: what a laboratory's two displacement channels add to a motion."""

from pathlib import Path

import pandas as pd

from reliab.api.arguments import Quantity, stated_values
from reliab.api.channels import Channels
from reliab.errors import InputError
from reliab.files import written_whole
from reliab.recordings import (
    ChannelCalibration,
    calibrate_channels,
    calibration_in_toml,
)


def calibrate(
    test: str | Path | pd.DataFrame,
    *,
    out: str | Path | None = None,
    actuator_delay: Quantity | None = None,
    channels: str | Path | None = None,
    test_name: str | None = None,
    command: str | None = None,
    measured: str | None = None,
    time: str | None = None,
    rate: float | None = None,
    units: str | None = None,
    time_units: str | None = None,
    delimiter: str | None = None,
) -> ChannelCalibration:
    """Measure skew, scale, hysteresis, noise and resolution of the two channels from a test made for it.

    Parameters
    ----------
    test : str, pathlib.Path or pandas.DataFrame
        Recording of one motion by both channels: sines, a sweep or steps with rests, of an actuator without
        a specimen or of one signal that is fed to both; of a locked actuator noise and resolution only.
    out : str or pathlib.Path, optional
        File `channels.toml` to write, for `channels` of :func:`reliab.assess`; it also keeps what the file
        `channels` states. One that exists is replaced only where it is the file `channels`.
    actuator_delay : float, str or StatedValue, optional
        Delay of the actuator in this test [ms], "12±0.5"; it is taken off the lag between the channels.
    channels : str or pathlib.Path, optional
        File `channels.toml` in which the laboratory states names, units and signs.
    test_name, command, measured, time, rate, units, time_units, delimiter : optional
        How the file is read, as for :func:`reliab.assess`.

    Returns
    -------
    ChannelCalibration
        With a standard deviation of each, and what limits them in sentences.

    Raises
    ------
    InputError
        If the file cannot be read, or its motion is not one from which the channels follow.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(0.0, 20.0, 0.001)
    >>> command, late = 0.02 * np.sin(6.0 * time), 0.02 * np.sin(6.0 * (time - 4e-4))
    >>> frame = pd.DataFrame({"time_s": time, "command_m": command, "measured_m": 1.01 * late})
    >>> measured = calibrate(frame)
    >>> round(measured.skew_ms.value, 3), round(measured.scale.value, 4)
    (0.4, 1.01)
    """
    recording = Channels(
        command=command,
        measured=measured,
        time=time,
        rate=rate,
        units=units,
        time_units=time_units,
        delimiter=delimiter,
        test_name=test_name,
        channels=channels,
    ).read(test)
    delay = stated_values(actuator_delay=actuator_delay).get("actuator_delay")
    calibration = calibrate_channels(recording, actuator_delay_ms=delay)
    if out is not None:
        _write(calibration, Path(out), None if channels is None else Path(channels), recording.name)
    return calibration


def _write(calibration: ChannelCalibration, out: Path, channels: Path | None, source: str) -> None:
    """Write a file of channels, with what another states."""
    if out.exists() and (channels is None or not out.samefile(channels)):
        raise InputError(
            "A file of channels is not replaced",
            value=out,
            remedy=f"Name another file, or give `channels` = {out} to keep what it states",
        )
    described = "" if channels is None else channels.read_text(encoding="utf-8")
    with written_whole(out) as file:
        file.write_text(calibration_in_toml(calibration, described, source), encoding="utf-8")
