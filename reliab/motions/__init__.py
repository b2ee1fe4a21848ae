"""Ground motions: readers, catalogues, suites, resampling and measures of intensity."""

from reliab.motions.checking import check_folder
from reliab.motions.faults import Fault
from reliab.motions.loading import load_motions, read_motion
from reliab.motions.motion import Motion
from reliab.motions.resampling import resample, truncate
from reliab.motions.suite import MotionSuite

__all__ = [
    "Fault",
    "Motion",
    "MotionSuite",
    "check_folder",
    "load_motions",
    "read_motion",
    "resample",
    "truncate",
]
