"""A test as a rig's folder keeps it: its indices, what is stated of it, and the whole assessment."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from datetime import datetime
from typing import Final

import numpy as np

from reliab.assessment.assessment import Assessment
from reliab.assessment.frame_assessment import FrameAssessment
from reliab.core.errors import InputError
from reliab.core.plain_values import PlainResult
from reliab.core.vocabulary import MILLI
from reliab.recordings.recording import Recording
from reliab.tracking.boundary.first_order import ellipse_of_response

SCHEMA: Final = "reliab rig test 1"
"""Value of `schema` in the JSON of a test."""


@dataclass(frozen=True, kw_only=True)
class RigTest(PlainResult):
    """One test of a rig; delays in milliseconds, displacements in millimetres."""

    sha256: str  # Of the laboratory's file, and of the test's name where the file holds several
    name: str
    file: str
    added: str  # When it came into the folder, in ISO 8601 and UTC
    date: str = ""  # When it was performed
    event: str = ""  # Earthquake of its ground motion
    specimen: str = ""
    note: str = ""
    structure: str = ""  # Name of the frame; empty for a structure of one mass
    f: float | None = None
    xi: float | None = None
    alpha: float | None = None
    threshold: float
    verdict: str
    reliable: bool
    probability: float
    A: float
    d_ms: float
    f_eq_hz: float
    remainder: float  # RMS of what gain and delay leave of the measured displacement, over its own RMS
    rms: float | None = None  # None where it is infinite
    rms_low: float | None = None
    rms_high: float | None = None
    mte: float | None = None
    peak_mm: float
    velocity_mm_s: float
    own_a: float | None = None  # a over the squared error by the test's own response
    own_b_ms2: float | None = None
    duration_s: float
    covariates: Mapping[str, float] = field(default_factory=dict)

    @property
    def moment(self) -> str:
        """What tests are ordered by: the date where it is stated, else when the test was added."""
        return self.date or self.added


COLUMNS: Final = tuple(item.name for item in fields(RigTest) if item.name != "covariates")
"""Columns of the table of a rig that every test has."""

TEXTS: Final = frozenset(
    ("sha256", "name", "file", "added", "date", "event", "specimen", "note", "structure", "verdict")
)
"""Columns that hold texts."""


def require_date(text: str) -> str:
    """Return a date or a time in ISO 8601 as it sorts.

    >>> require_date("2026-03-01"), require_date("2026-03-01 14:30")
    ('2026-03-01T00:00:00', '2026-03-01T14:30:00')
    """
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise InputError(
            "`date` is neither a day nor a time",
            value=repr(text),
            remedy="Write 2026-03-01 or 2026-03-01T14:30",
        ) from None
    return moment.replace(tzinfo=None).isoformat(timespec="seconds")


_STEEPEST = 0.999  # quantile of the speeds, beyond which there is the noise of the command


def describe_test(
    assessment: Assessment | FrameAssessment, texts: Mapping[str, str], covariates: Mapping[str, float]
) -> RigTest:
    """Take from an assessment what a rig's table holds; `texts` are its names and labels."""
    content = assessment.to_dict()
    errors = content["error"]
    own_a, own_b = _own_ellipse(assessment)
    peak, velocity = _peaks_of(assessment.recording)
    return RigTest(
        **texts,
        f=content.get("f"),
        xi=content.get("xi"),
        alpha=content.get("alpha"),
        structure=str(content.get("structure", "")),
        threshold=content["threshold"],
        verdict=content["verdict"],
        reliable=content["reliable"],
        probability=content["probability"],
        A=content["A"],
        d_ms=content["d_ms"],
        f_eq_hz=content["f_eq_hz"],
        remainder=assessment.tracking.noise_share,
        rms=errors["rms"]["value"],
        rms_low=errors["rms"]["low"],
        rms_high=errors["rms"]["high"],
        mte=errors["mte"]["value"],
        peak_mm=peak,
        velocity_mm_s=velocity,
        own_a=own_a,
        own_b_ms2=own_b,
        duration_s=assessment.recording.duration,
        covariates=covariates,
    )


def _peaks_of(recording: Recording) -> tuple[float, float]:
    """Peak displacement [mm] and speed [mm/s] of the command."""
    command = recording.command - recording.command.mean()
    speed = np.abs(np.gradient(command, recording.time_step))
    return MILLI * float(np.abs(command).max()), MILLI * float(np.quantile(speed, _STEEPEST))


def _own_ellipse(assessment: Assessment | FrameAssessment) -> tuple[float | None, float | None]:
    """How much gain and delay weigh in the response of this very test; unknown for frames."""
    if not isinstance(assessment, Assessment):
        return None, None
    rebuilt = assessment.error.rebuilt
    ellipse = ellipse_of_response(rebuilt.reference, rebuilt.time_step, assessment.structure)
    if not all(math.isfinite(value) and value > 0.0 for value in (ellipse.amplitude, ellipse.delay)):
        return None, None
    return ellipse.amplitude, ellipse.delay
