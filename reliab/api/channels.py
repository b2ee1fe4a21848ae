"""A test as users give it, and what they state of its file."""

from dataclasses import asdict, dataclass, replace
from pathlib import Path

import pandas as pd

from reliab.api.arguments import unused
from reliab.errors import InputError
from reliab.recordings import Recording, read_recording, read_tests
from reliab.shipped import or_shipped

Test = str | Path | pd.DataFrame | Recording
"""A test, its file, its data frame, or the name of one that ships."""


@dataclass(frozen=True, kw_only=True)
class Channels:
    """What is stated of a test's file; see `reliab.assess`."""

    command: str | None = None
    measured: str | None = None
    time: str | None = None
    rate: float | None = None
    units: str | None = None
    time_units: str | None = None
    delimiter: str | None = None
    test_name: str | None = None
    channels: str | Path | None = None

    def read_all(self, test: str | Path) -> list[Recording]:
        """Read all tests of a file."""
        path = or_shipped(Path(test), "datasets", "test.csv")
        names = [columns.test for columns in read_tests(path, delimiter=self.delimiter)]
        return [replace(self, test_name=name or None).read(test) for name in names]

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
        for name in ("delimiter", "test_name") if isinstance(test, pd.DataFrame) else ():
            if getattr(self, name) is not None:
                raise unused(name, "beside a data frame")
        return read_recording(
            test if isinstance(test, pd.DataFrame) else or_shipped(Path(test), "datasets", "test.csv"),
            command=self.command,
            measured=self.measured,
            time=self.time,
            rate_hz=None if self.rate is None else float(self.rate),
            units=self.units,
            time_units=self.time_units,
            delimiter=self.delimiter,
            test=self.test_name,
            channels=self.channels,
        )
