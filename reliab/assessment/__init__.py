"""The verdict on a real test, and what is tolerable before one."""

from reliab.assessment.assess import assess
from reliab.assessment.assessment import Assessment
from reliab.assessment.default_criterion import default_criterion
from reliab.assessment.design import Tolerance, tolerable_errors
from reliab.recordings.reading import read_recording
from reliab.recordings.recording import Recording

__all__ = [
    "Assessment",
    "Recording",
    "Tolerance",
    "assess",
    "default_criterion",
    "read_recording",
    "tolerable_errors",
]
