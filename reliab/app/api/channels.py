"""A test as users give it, and what they state of its file."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from reliab.app.api.arguments import parse_filters, refuse_stated, refuse_unused
from reliab.core.errors import InputError
from reliab.core.progress import Progress
from reliab.core.shipped import or_shipped
from reliab.core.stated_value import require_physical
from reliab.recordings.readers.columns import is_frame
from reliab.recordings.readers.registry import read_tests
from reliab.recordings.reading import ChannelHistories, declare_channels, read_recording
from reliab.recordings.record import About, record_test
from reliab.recordings.recording import Part, Recording, StatedChannels

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd
    import xarray as xr
    from typing_extensions import TypeIs

    from reliab.assessment.assess import AnyAssessment
    from reliab.assessment.several import Assessments
    from reliab.core.stated_value import StatedValue
    from reliab.signals.filters import LowPass

Test: TypeAlias = "str | Path | pd.DataFrame | Recording"
"""A test, its file, its data frame, or the name of one that ships."""


def find_test(test: str | Path) -> Path:
    """Find the file of a test: the one that ships by its name, else the one of the path."""
    return or_shipped(Path(test), "datasets", "test.csv")


def is_test(value: object) -> "TypeIs[Test]":
    """Tell one test from several."""
    return isinstance(value, str | Path | Recording) or is_frame(value)


@dataclass(frozen=True, kw_only=True)
class FileReading:
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

    @classmethod
    def from_question(cls, question: "Mapping[str, Any]") -> "FileReading":
        """Take what a question says of a test's file."""
        return cls(**{item.name: question.get(item.name) for item in fields(cls)})

    def laboratory(self) -> StatedChannels:
        """Return what the laboratory states of its channels."""
        columns = {Part.COMMAND: self.command, Part.MEASURED: self.measured, Part.TIME: self.time}
        return declare_channels(self.channels, columns, self.units, self.rate)

    def split_by_test(self, test: str | Path) -> "dict[str, FileReading]":
        """Return what is stated of each test of a file, by file and name."""
        path = find_test(test)
        names = [columns.test for columns in read_tests(path, delimiter=self.delimiter)]
        return {
            f"{path.name}, {name}" if name else path.name: replace(self, test_name=name or None)
            for name in names
        }

    def filters(
        self, option_filters: "Mapping[str, LowPass]", test_values: "Mapping[str, StatedValue]"
    ) -> "dict[str, LowPass]":
        """Return the filters of the channels, by options before those of the laboratory's file.

        `of_test`: what is stated of the test, with a skew that was calibrated where "filter_delay" is.
        """
        file_filters: Mapping[str, str] = {}
        if self.channels is not None:
            from reliab.recordings.channels_file import read_channels_file

            file_filters = read_channels_file(self.channels).filters
        texts = (
            f"{channel}={text}" for channel, text in file_filters.items() if channel not in option_filters
        )
        filters = {**parse_filters(texts), **option_filters}
        if filters and "filter_delay" in test_values:
            raise refuse_unused(
                "filter", "together with a calibrated skew, which includes the delay of the filters"
            )
        return filters

    def read(self, test: Test, *, several: bool = False) -> Recording:
        """Read a test; `several`: whether it has several actuators."""
        if several:
            reason = "together with a `structure` with several actuators; name the columns command_1, …"
            refuse_stated(vars(self), "command", "measured", reason=reason)
        if isinstance(test, Recording):
            refuse_stated(vars(self), *vars(self), reason="together with a test that was already read")
            if test.has_several and not several:
                raise InputError(
                    "Several actuators need the `structure` that they drove",
                    value=f"{len(test.actuators)} actuators",
                    remedy="Give the file of the frame with `structure`",
                )
            return test
        if self.rate is not None:
            require_physical("sampling rate", float(self.rate), label="value of `rate`")
        if is_frame(test):
            refuse_stated(vars(self), "delimiter", "test_name", reason="together with a data frame")
        arguments = {**vars(self)}
        return read_recording(
            test if is_frame(test) else find_test(test),
            rate_hz=arguments.pop("rate"),
            test=arguments.pop("test_name"),
            several=several,
            **arguments,
        )

    def record(self, path: Path, about: About) -> "tuple[xr.Dataset, ChannelHistories]":
        """Make the record of a test, and say what was recognised."""
        return record_test(
            path,
            laboratory=self.laboratory(),
            test=self.test_name,
            about=about,
            time_units=self.time_units,
            delimiter=self.delimiter,
        )


Judge: TypeAlias = "Callable[[FileReading, Test], AnyAssessment]"
"""Reads and judges a test."""


def assess_each(
    tests: Iterable[tuple[str, FileReading, Test]], judge: Judge, progress: Progress
) -> "Assessments":
    """Judge tests, each with its name and what is stated of its channels."""
    from reliab.assessment.several import Assessments

    tests_by_name: dict[str, tuple[FileReading, Test]] = {}
    for file, channels, test in tests:
        if file in tests_by_name:
            raise InputError(
                f"{file} is given twice",
                remedy="Leave it out once, or give the recordings different names",
            )
        tests_by_name[file] = channels, test
    if not tests_by_name:
        raise InputError(
            "No test given",
            remedy="Name its file; before a test use `reliab design`, in Python `reliab.design_test`",
        )
    assessments, faults = {}, {}
    for count, (file, (channels, test)) in enumerate(tests_by_name.items(), start=1):
        try:
            assessments[file] = judge(channels, test)
        except InputError as error:
            faults[file] = str(error)
        progress(count, len(tests_by_name))
    return Assessments(files=tuple(tests_by_name), judged=assessments, faults=faults)


def name_of_test(test: Test, place: int) -> str:
    """Name a test; data frames by their place."""
    if isinstance(test, Recording):
        return test.name
    return str(test) if isinstance(test, str | Path) else f"data frame {place + 1}"
