"""The verdict on a real test, and what is tolerable before one."""

from reliab.validation.assessment.assess import assess
from reliab.validation.assessment.assessment import Assessment
from reliab.validation.assessment.default_criterion import default_criterion
from reliab.validation.assessment.design import Tolerance, tolerable_errors
from reliab.validation.assessment.reading import read_recording
from reliab.validation.assessment.recording import Recording

__all__ = [
    "Assessment",
    "Recording",
    "Tolerance",
    "assess",
    "default_criterion",
    "read_recording",
    "tolerable_errors",
]
