"""`reliab.record`, `reliab.calibrate`: a laboratory's file as a record, and what its channels add to it."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Unpack

import pandas as pd

from reliab.app import questions
from reliab.app.api.arguments import require_sound, stated_quantities, structure_of
from reliab.app.api.channels import FileReading, find_test
from reliab.app.declaration import asks
from reliab.core.errors import InputError
from reliab.core.files import refuse_unwritable, require_ending, written_whole
from reliab.core.plain_values import Keys, PlainResult, plot_histories, same_names
from reliab.recordings.calibration import ChannelCalibration, calibrate_channels, calibration_in_toml
from reliab.recordings.reading import ChannelHistories
from reliab.recordings.record import About, check_record, write_csv, write_record
from reliab.recordings.recording import Channel

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_USUAL = {"f": 1.0, "xi": 0.05}
"""A structure, of which a user may state any part."""


@dataclass(frozen=True, kw_only=True)
class Record(PlainResult):
    """A record that was made: what was recognised in a file, and what was written."""

    keys: ClassVar[Keys] = {
        **same_names("source", "files"),
        "test": "histories.columns.test",
        "rate_hz": "rate",
        "samples": "samples",
        "recording": {"channels": "channels"},
        "left": "unused_columns",
        "notes": "histories.notes",
    }

    source: Path
    files: tuple[Path, ...]
    histories: ChannelHistories

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return 1.0 / self.histories.time_step

    @property
    def samples(self) -> int:
        """Number of samples of each channel."""
        return next(iter(self.histories.values.values())).size

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Channels that were recognised."""
        return tuple(self.histories.channels.values())

    @property
    def unused_columns(self) -> list[str]:
        """Names of the columns that are no channel."""
        used = {channel.column for channel in self.channels}
        return [name for name in self.histories.columns.values if name not in used]

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the channels over time [s], in SI units."""
        histories = {str(name): values for name, values in self.histories.values.items()}
        return plot_histories(histories, self.histories.time_step, title=self.source.name, axes=axes)


@asks(questions.RecordQuestion)
def record(
    source: str | Path,
    out: str | Path | None = None,
    *,
    attributes: Mapping[str, str] | None = None,
    **options: Unpack[questions.RecordQuestion],
) -> Record:
    """Recognise the channels of a test, and write them as one open record.

    Parameters
    ----------
    source : str or pathlib.Path
        File of a laboratory, in any format that `reliab.assess` reads.
    out : str or pathlib.Path, optional
        NetCDF file of the record.
    attributes : mapping of str to str, optional
        Further attributes.

    Raises
    ------
    InputError
        If the file cannot be read, its channels cannot be told from each other, or a file cannot be written.
    """
    csv = options["csv"]
    if out is not None:
        require_ending(out, ".nc")
    path = find_test(source)
    structure = stated_quantities(options)
    require_sound(structure)
    structure_of(structure, **_USUAL)  # refuses values that no structure has
    statements = {**structure, **questions.select_stated(questions.OriginOptions, options)}
    texts = {name: str(value) for name, value in statements.items()}
    about = About(**texts, further=dict(attributes or {}))
    dataset, histories = FileReading.from_question(options).record(path, about)
    files = []
    with refuse_unwritable("Cannot write the record", where=out or csv):
        if out is not None:
            write_record(dataset, out)
            files.append(Path(out))
        if csv is not None:
            write_csv(dataset, histories, csv)
            files.append(Path(csv))
    return Record(source=path, files=tuple(files), histories=histories)


def check_records(sources: list[Path]) -> dict[str, list[str]]:
    """Examine NetCDF files of records; return what is wrong with each, in sentences by file.

    Parameters
    ----------
    sources : list of pathlib.Path
        NetCDF files.

    Returns
    -------
    dict of str to list of str
        Faults by file; none for a sound record.

    Raises
    ------
    InputError
        If a file is no NetCDF file.
    """
    return {str(path): check_record(path) for path in sources}


@asks(questions.CalibrationQuestion, questions.CALIBRATION_TEST)
def calibrate(
    test: str | Path | pd.DataFrame, **options: Unpack[questions.CalibrationQuestion]
) -> ChannelCalibration:
    """Measure skew, scale, hysteresis, noise and resolution of the two channels from a test made for it.

    The file `out` also keeps what the file `channels` states; one that exists is replaced only if it is that
    file.

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
    >>> time = np.arange(0.0, 20.0, 0.004)
    >>> command, late = 0.02 * np.sin(6.0 * time), 0.02 * np.sin(6.0 * (time - 4e-4))
    >>> frame = pd.DataFrame({"time_s": time, "command_m": command, "measured_m": 1.01 * late})
    >>> measured = calibrate(frame)
    >>> round(measured.skew_ms.value, 3), round(measured.scale.value, 4)
    (0.4, 1.01)
    """
    reading, out = FileReading.from_question(options), options["out"]
    recording = reading.read(test)
    delay = stated_quantities(options).get("actuator_delay")
    calibration = calibrate_channels(recording, actuator_delay_ms=delay)
    if out is not None:
        previous_file = None if reading.channels is None else Path(reading.channels)
        _write(calibration, Path(out), previous_file, recording.name)
    return calibration


def _write(calibration: ChannelCalibration, out: Path, channels: Path | None, source: str) -> None:
    """Write a file of channels, with what another states."""
    if out.exists() and (channels is None or not out.samefile(channels)):
        raise InputError(
            f"{out} exists already",
            remedy=f"Name another file, or give `channels` = {out} to keep what it states",
        )
    previous_text = "" if channels is None else channels.read_text(encoding="utf-8")
    with written_whole(out) as file:
        file.write_text(calibration_in_toml(calibration, previous_text, source), encoding="utf-8")
