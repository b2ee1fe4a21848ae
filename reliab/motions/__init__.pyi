from .checking import inspect as inspect
from .faults import Fault as Fault, fault_of as fault_of
from .intensity import arias_times as arias_times, measure as measure
from .loading import (
    find_motions as find_motions,
    load_motions as load_motions,
    read_motion as read_motion,
    skipped_files as skipped_files,
)
from .motion import Motion as Motion, resample as resample, truncate as truncate
from .outline import are_copies as are_copies, outline_of as outline_of
from .suite import MotionSuite as MotionSuite
from .writing import write_suite as write_suite
