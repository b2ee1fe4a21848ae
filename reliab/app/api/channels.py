"""A test as users give it, and what they state of its file."""

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from reliab.app.api.arguments import parse_filters, refuse_unused
from reliab.core.errors import InputError
from reliab.core.physical_range import require_physical
from reliab.core.progress import Progress
from reliab.core.shipped import or_shipped
from reliab.recordings.coupled_recording import CoupledRecording, read_coupled_recording
from reliab.recordings.readers.columns import is_frame
from reliab.recordings.readers.registry import read_tests
from reliab.recordings.reading import declare_channels, read_recording
from reliab.recordings.recording import Part, Recording, StatedChannels

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd
    from typing_extensions import TypeIs

    from reliab.assessment.assessment import Assessment
    from reliab.assessment.frame_assessment import CoupledAssessment, FrameAssessment
    from reliab.assessment.several import Assessments
    from reliab.core.stated_value import StatedValue
    from reliab.signals.filters import LowPass

Test: TypeAlias = "str | Path | pd.DataFrame | Recording | CoupledRecording"
"""A test, its file, its data frame, or the name of one that ships."""


def is_test(value: object) -> "TypeIs[Test]":
    """Tell one test from several."""
    return isinstance(value, str | Path | Recording | CoupledRecording) or is_frame(value)


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

    @classmethod
    def from_question(cls, question: "Mapping[str, Any]") -> "Channels":
        """Take what a question says of a test's file."""
        return cls(**{item.name: question.get(item.name) for item in fields(cls)})

    def laboratory(self) -> StatedChannels:
        """Return what the laboratory states of its channels."""
        columns = {Part.COMMAND: self.command, Part.MEASURED: self.measured, Part.TIME: self.time}
        return declare_channels(self.channels, columns, self.units, self.rate)

    def split_by_test(self, test: str | Path) -> "dict[str, Channels]":
        """Return what is stated of each test of a file, by file and name."""
        path = or_shipped(Path(test), "datasets", "test.csv")
        names = [columns.test for columns in read_tests(path, delimiter=self.delimiter)]
        return {
            f"{path.name}, {name}" if name else path.name: replace(self, test_name=name or None)
            for name in names
        }

    def filters(
        self, of_options: "Mapping[str, LowPass]", of_test: "Mapping[str, StatedValue]"
    ) -> "dict[str, LowPass]":
        """Return the filters of the channels, by options before those of the laboratory's file.

        `of_test`: what is stated of the test, with a skew that was calibrated where "filter_delay" is.
        """
        of_file: Mapping[str, str] = {}
        if self.channels is not None:
            from reliab.recordings.channels_file import read_channels_file

            of_file = read_channels_file(self.channels).filters
        texts = (f"{channel}={text}" for channel, text in of_file.items() if channel not in of_options)
        filters = {**parse_filters(texts), **of_options}
        if filters and "filter_delay" in of_test:
            raise refuse_unused(
                "filter", "together with a calibrated skew, which includes the delay of the filters"
            )
        return filters

    def read_several_actuators(self, test: Test) -> CoupledRecording:
        """Read a test with several actuators."""
        for name in ("command", "measured"):
            if getattr(self, name) is not None:
                raise refuse_unused(
                    name, "together with a `structure` with several actuators; name the columns command_1, …"
                )
        if isinstance(test, Recording):
            raise InputError(
                "This structure has several actuators, and the test needs the channels of all of them",
                value="a recording of one",
                remedy="Give its file, a data frame or a `CoupledRecording`",
            )
        if isinstance(test, CoupledRecording):
            return test
        self._require_sound(test)
        return read_coupled_recording(
            test if is_frame(test) else Path(test),
            declare_channels(self.channels, {}, self.units, None if self.rate is None else float(self.rate)),
            delimiter=self.delimiter,
            test=self.test_name,
            time_units=self.time_units,
        )

    def read(self, test: Test) -> Recording:
        """Read a test."""
        given = [name for name, value in asdict(self).items() if value is not None]
        if isinstance(test, Recording):
            if given:
                raise refuse_unused(given[0], "together with a test that was already read")
            return test
        if isinstance(test, CoupledRecording):
            raise InputError(
                "Several actuators need the `structure` that they drove",
                value=f"{len(test.actuators)} actuators",
                remedy="Give the file of the frame with `structure`",
            )
        self._require_sound(test)
        return read_recording(
            test if is_frame(test) else or_shipped(Path(test), "datasets", "test.csv"),
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

    def _require_sound(self, test: Test) -> None:
        """Refuse a rate that is none, and what a data frame does not have."""
        if self.rate is not None:
            require_physical("sampling rate", float(self.rate), label="value of `rate`")
        for name in ("delimiter", "test_name") if is_frame(test) else ():
            if getattr(self, name) is not None:
                raise refuse_unused(name, "together with a data frame")


Judge: TypeAlias = Callable[[Channels, Test], "Assessment | FrameAssessment | CoupledAssessment"]
"""Reads and judges a test."""


def assess_each(
    tests: Iterable[tuple[str, Channels, Test]], judge: Judge, progress: Progress
) -> "Assessments":
    """Judge tests, each with its name and what is stated of its channels."""
    from reliab.assessment.several import Assessments

    by_file: dict[str, tuple[Channels, Test]] = {}
    for file, channels, test in tests:
        if file in by_file:
            raise InputError(
                f"{file} is given twice",
                remedy="Leave it out once, or give the recordings different names",
            )
        by_file[file] = channels, test
    if not by_file:
        raise InputError(
            "No test given",
            remedy="Name its file; before a test use `reliab design`, in Python `reliab.design_test`",
        )
    judged, faults = {}, {}
    for done, (file, (channels, test)) in enumerate(by_file.items(), start=1):
        try:
            judged[file] = judge(channels, test)
        except InputError as error:
            faults[file] = str(error)
        progress(done, len(by_file))
    return Assessments(files=tuple(by_file), judged=judged, faults=faults)


def name_of_test(test: Test, place: int) -> str:
    """Name a test; data frames by their place."""
    if isinstance(test, Recording | CoupledRecording):
        return test.name
    return str(test) if isinstance(test, str | Path) else f"data frame {place + 1}"
