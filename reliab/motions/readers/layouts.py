"""How publishers of records lay out their text files, one row each; all headers are read by one lexer.

References
----------
NIED, *K-NET ASCII format* and *K-NET and KiK-net: questions and answers*, questions 1 and 2.
Shakal, A. F. and Huang, M. J. (1985). *Standard tape format for CSMIP strong-motion data tapes.* OSMS 85-03.
COSMOS Strong Motion Programs Board (2001). *COSMOS strong motion data format*, version 1.20.
Cousins, W. J. (2008). *GNS accelerogram data files: standard format.*
U.S. Geological Survey. *SMC-format data files.*
"""

import re
from dataclasses import dataclass

from reliab.motions.readers import events, numeric_headers
from reliab.motions.readers.source import HEAD, Source
from reliab.motions.units import AccelerationUnit

_FLAGS = re.IGNORECASE | re.MULTILINE


def _pattern(text: str) -> re.Pattern[bytes]:
    return re.compile(text.encode(), _FLAGS)


@dataclass(frozen=True, kw_only=True)
class Layout:
    """Where the parts of a text file stand, and what they mean by definition."""

    name: str  # Name shown to users
    endings: tuple[str, ...] = ()  # Endings of names by which a file counts as one
    mark: re.Pattern[bytes] | None = None  # Stands in the head of every such file, and of no other
    first: re.Pattern[bytes] | None = None  # First line of each record, where a file may hold several
    last: re.Pattern[bytes] | None = None  # Last line of a header, if lines of numbers may stand before it
    end: re.Pattern[bytes] | None = None  # First line after the samples
    states: str = "hold samples"  # What such a file must do, for messages
    is_announced: bool = False  # Whether the last line of the header alone states count, step and units
    wraps: bool = False  # Whether samples follow one another through the lines, as many as are stated
    holds_components: bool = False  # Whether each column is a component of acceleration
    has_duration: bool = False  # Whether the duration tells the count or the step
    default_units: AccelerationUnit | None = None  # Units where the header states none
    remove_mean: bool = False  # Whether the publisher subtracts the mean of the whole record
    find_event: events.FindEvent = events.find_event  # Names the earthquake
    # Reads what stands at fixed places between the header's text and the samples
    complete: numeric_headers.Complete = numeric_headers.leave_as_it_is

    @property
    def subject(self) -> str:
        """The file, as the beginning of a rule."""
        return "A text record" if self.mark is None else f"A {self.name} file"

    @property
    def holds_one(self) -> bool:
        """Whether a file holds one record, of which the head tells all that the header states."""
        return self.last is not None and not self.is_announced

    def recognises(self, source: Source) -> bool:
        """Tell from the head of a file whether it has this layout."""
        return self.mark is not None and self.mark.search(source.content[:HEAD].lstrip()) is not None


_SIZES = _pattern(
    r"^(?![ \t]*[#%!])(?=[^\n]{0,1000}$)[^\n]*(?:\bNPTS\b[^\n]*\bDT\b|\bDT\b[^\n]*\bNPTS\b)[^\n]*$"
)
_ACCELERATION_POINTS = _pattern(
    r"^[ \t]*\S*[ \t]+points[ \t]+of[ \t]+accel\w*[ \t]+data[ \t]+equally[ \t]+spaced[ \t]+at\b[^\n]*$"
)
_ACCELEROGRAM = r"(?![#%!])[^\n]*\b(?:un)?corrected accelerogram\b[^\n]*"
_END = r"/&|[^\n]*\bend[ \t-]+of[ \t-]+data\b"

LAYOUTS = (
    Layout(
        name="PEER AT2",
        endings=(".at2",),
        mark=_SIZES,
        last=_SIZES,
        states="state NPTS and DT",
        wraps=True,
        default_units=AccelerationUnit.GRAVITY,
        find_event=events.find_titled_event,
    ),
    Layout(
        name="K-NET",
        endings=(".ns", ".ew", ".ud", ".ns1", ".ew1", ".ud1", ".ns2", ".ew2", ".ud2"),
        mark=_pattern(r"\AOrigin Time[ \t](?:[^\n]*\n){1,30}?Scale Factor\b"),
        last=_pattern(r"^Memo\b[^\n]*$"),
        states="hold its labels from Origin Time to Memo",
        wraps=True,
        has_duration=True,
        remove_mean=True,
        find_event=events.find_event_with_place,
    ),
    Layout(
        name="K-NET CSV",
        mark=_pattern(r"\A#K-NET CSV\b"),
        has_duration=True,
        find_event=events.find_event_with_place,
    ),
    Layout(
        name="COSMOS",
        endings=(".v2c", ".v1c"),
        mark=_pattern(r"\A[^\n]*\(Format\s+v\s*[\d.]+[^\n]*text\s+lines"),
        last=_pattern(r"^[ \t]*\S+[ \t]+accel\w*[ \t]+(?:data[ \t]+)?(?:pts|points)\b[^\n]*$"),
        end=_pattern(rf"^(?:{_END}|[ \t]*\S+[ \t]+(?:veloc|displ)\w*[ \t]+(?:data[ \t]+)?(?:pts|points)\b)"),
        states="hold acceleration",
        is_announced=True,
        wraps=True,
        complete=numeric_headers.read_cosmos,
        find_event=events.find_american_event,
    ),
    Layout(
        name="CSMIP",
        endings=(".v2", ".raw"),
        mark=_ACCELERATION_POINTS,
        last=_ACCELERATION_POINTS,
        end=_pattern(rf"^(?:{_END}|[^\n]*\bpoints[ \t]+of[ \t]+(?:veloc|displ))"),
        states="announce its points of accel data",
        is_announced=True,
        wraps=True,
        find_event=events.find_american_event,
    ),
    Layout(
        name="SMC",
        endings=(".smc",),
        mark=_pattern(r"\A[ \t]*\d[ \t]+(?:(?:UN)?CORRECTED|RESPONSE|FOURIER)\b[^\n]*\n\*"),
        last=_pattern(r"\A(?:[^\n]*\n){10}[^\n]*$"),
        states="have eleven lines of text above its numbers",
        wraps=True,
        complete=numeric_headers.read_smc,
        default_units=AccelerationUnit.CENTIMETRE,
        find_event=events.find_event_in_words,
    ),
    Layout(
        name="GeoNet",
        endings=(".v1a", ".v2a"),
        mark=_pattern(rf"\A{_ACCELEROGRAM}\bGNS\b"),
        first=_pattern(rf"^{_ACCELEROGRAM}$"),
        end=_pattern(r"^[^\n]*[a-z]{3}"),
        states="state its number of points",
        wraps=True,
        complete=numeric_headers.read_volume,
        default_units=AccelerationUnit.MILLIMETRE,
        find_event=events.find_event_in_words,
    ),
    Layout(  # of CSMIP, USC, RENADIC and BHRC
        name="Volume 1 or 2",
        endings=(".v1",),
        mark=_pattern(rf"\A(?:\*[ \t]*VOL[12]|{_ACCELEROGRAM})|\bUNCOR ACCEL\b"),
        first=_pattern(rf"^(?:\*[ \t]*VOL[12][^\n]*|{_ACCELEROGRAM})$"),
        end=_pattern(rf"^(?:{_END}|[^\n]*[a-z]{{3}}|\*)"),
        states="state its number of points",
        wraps=True,
        complete=numeric_headers.read_volume,
        has_duration=True,
        find_event=events.find_american_event,
    ),
    Layout(name="ESM", mark=_pattern(r"\AEVENT_NAME[ \t]*:")),
    Layout(name="AFAD", mark=_pattern(r"\A[^\n]*\bstrong[ -]ground[ -]motion records?\b")),
    Layout(name="CWB", mark=_pattern(r"\A#(?:StationCode|Earthquake Information)\b")),
    Layout(
        name="ASA",
        mark=_pattern(r"\barchivo est\w+ndar de aceleraci"),
        holds_components=True,
        default_units=AccelerationUnit.CENTIMETRE,
    ),
)
"""Layouts that are recognised whatever the ending of a file's name."""

PLAIN = Layout(name="text", endings=(".txt", ".csv", ".tsv", ".dat", ".asc", ".acc"))
"""Any header that states what is needed above columns of numbers."""
