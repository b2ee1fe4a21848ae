"""How the file of a test is read: names of its columns, their units, and the sampling rate."""

from dataclasses import asdict, dataclass
from pathlib import Path

import pandas as pd

from reliab.api.arguments import unused
from reliab.errors import InputError
from reliab.recordings import Recording, read_recording
from reliab.shipped import or_shipped

Test = str | Path | pd.DataFrame | Recording
"""A test, its file, its data frame, or the name of one that ships."""


@dataclass(frozen=True, kw_only=True)
class Channels:
    """What is stated of a test's file; see `reliab.assess`."""

    command: str | None
    measured: str | None
    time: str | None
    rate: float | None
    units: str | None
    time_units: str | None
    delimiter: str | None

    def read(self, test: Test) -> Recording:
        """Read a test."""
        given = [name for name, value in asdict(self).items() if value is not None]
        if isinstance(test, Recording):
            if given:
                raise unused(given[0], "beside a test that was read already")
            return test
        if self.rate is not None and not 0.0 < self.rate < float("inf"):
            raise InputError(
                "The value of `rate` must be positive and finite",
                value=float(self.rate),
                remedy="Give the samples in a second",
            )
        if isinstance(test, pd.DataFrame) and self.delimiter is not None:
            raise unused("delimiter", "beside a data frame")
        return read_recording(
            test if isinstance(test, pd.DataFrame) else or_shipped(Path(test), "datasets", "test.csv"),
            command=self.command,
            measured=self.measured,
            time=self.time,
            rate_hz=None if self.rate is None else float(self.rate),
            units=self.units,
            time_units=self.time_units,
            delimiter=self.delimiter,
        )
