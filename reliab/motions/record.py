"""A motion of a suite whose record has not been read yet."""

from dataclasses import dataclass, field
from pathlib import Path

from reliab.motions.faults import Report
from reliab.motions.motion import Motion
from reliab.motions.readers.header import Header
from reliab.motions.readers.reading import Declared, Reading, complete
from reliab.motions.readers.registry import open_records


@dataclass(frozen=True, kw_only=True)
class RecordFile:
    """An entry of a suite whose record is read from a file."""

    path: Path  # The file
    name: str  # Name of the motion
    event: str = ""  # The earthquake; if empty, it is taken from the header, or else from the name
    set_name: str = ""  # Set of the catalogue
    channel: int | None = None  # Which record of a file that holds several, counted from 1
    # Step and units that a catalogue or a caller gives for the record
    declared: Declared = field(default_factory=Declared)

    def load(self) -> Motion:
        """Read the motion."""
        report = Report(file=str(self.path))
        reading = report.require(self.read(report))
        return Motion(
            name=self.name,
            acceleration=reading.acceleration,
            time_step=reading.time_step,
            event=self.event or reading.event,
            set_name=self.set_name,
        )

    def read(self, report: Report) -> Reading | None:
        """Read the record and report every fault of it."""
        opened = open_records(self.path, report)
        if opened is None:
            return None
        source, headers = opened
        header = self._choose(headers, report)
        return None if header is None else complete(source, header, self.declared, report)

    def _choose(self, headers: list[Header], report: Report) -> Header | None:
        if self.channel is None and len(headers) > 1:
            labels = ", ".join(f"{n} ({header.channel})" for n, header in enumerate(headers, start=1))
            report.add(
                "The file holds several channels",
                value=f"channels {labels}",
                remedy="Choose a channel, or load the file as a suite",
            )
        elif self.channel is not None and not 1 <= self.channel <= len(headers) and headers:
            report.add(
                "No such channel in the file",
                value=f"channel {self.channel} of {len(headers)}",
                remedy="Count the channels of the file from 1",
            )
        elif headers:
            return headers[(self.channel or 1) - 1]
        return None
