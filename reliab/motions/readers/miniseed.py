"""miniSEED, through ObsPy.

A file does not say in which units its samples are, so the user gives them. Channels of one station that begin
at the same time are components of one earthquake.

References
----------
FDSN. *SEED reference manual*, version 2.4, appendix A.
"""

import io
import re
import warnings
from typing import Any

import numpy as np

from reliab.core.errors import InputError
from reliab.core.files import decoding
from reliab.motions.faults import Report
from reliab.motions.readers.source import RecordHeader, RecordText, Statement

_RECORD = re.compile(rb"[0-9]{6}[DRQM][ \x00]|MS\x03")
_SEISMOMETER = re.compile(r"[A-Z][HP][A-Z0-9]")  # codes of channels; an accelerometer is HNE or so


def is_of_seismometer(channel: str) -> bool:
    """Tell whether the code of a channel is one of a seismometer, which records velocity."""
    return _SEISMOMETER.fullmatch(channel) is not None


def recognises(source: RecordText) -> bool:
    """Tell whether a file begins with a record of miniSEED."""
    return _RECORD.match(source.content) is not None


def headers(source: RecordText, report: Report) -> list[RecordHeader]:
    """Read all channels of a miniSEED file."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of other libraries, that ObsPy imports
        try:
            import obspy
        except ModuleNotFoundError:
            report.add(
                "Reading miniSEED needs ObsPy, which is not installed",
                remedy='Install it with pip install "reliab[records]", or export the record as text',
            )
            return []
        warnings.simplefilter("error")  # a file that ends early is only worth a warning to ObsPy
        warnings.simplefilter("ignore", DeprecationWarning)
        try:
            with decoding("The miniSEED file is damaged", remedy="Download it again", where=report.file):
                traces = list(obspy.read(io.BytesIO(source.content), format="MSEED"))
                _report_gaps([trace.id for trace in traces], report)
                return [_header(trace, report) for trace in traces]
        except InputError as error:
            report.add(error.rule, value=error.value or "", remedy=error.remedy)
            return []


def _report_gaps(channels: list[str], report: Report) -> None:
    """Report channels that stand in several pieces."""
    for channel in sorted({channel for channel in channels if channels.count(channel) > 1}):
        report.add(
            "The record has gaps",
            value=f"channel {channel} in {channels.count(channel)} pieces",
            remedy="Fill the gaps, or save each piece as its own file",
        )


def _header(trace: Any, report: Report) -> RecordHeader:  # noqa: ANN401 - ObsPy has no types
    stats = trace.stats
    if is_of_seismometer(stats.channel):
        report.add(
            "Not a record of acceleration",
            value=f"velocity (channel {stats.channel} belongs to a seismometer)",
            remedy="Export the acceleration; if this is acceleration, rename its channel, for example HNE",
        )
    if trace.data.dtype.kind != "f":
        report.add(
            "The samples are not acceleration",
            value="counts of a digitizer",
            remedy="Remove the instrument response, for example with ObsPy, and save floating-point numbers",
        )
    with np.errstate(invalid="ignore"):  # of damaged numbers, which are refused later
        values = np.asarray(trace.data if trace.data.dtype.kind in "fiu" else [], dtype=np.float64)
    return RecordHeader(
        time_step=Statement(value=float(stats.delta), line=None) if stats.delta > 0 else None,
        event=f"{stats.network}.{stats.station} {stats.starttime.strftime('%Y-%m-%d %H:%M:%S')}",
        channel=str(stats.channel),
        values=values,
    )
