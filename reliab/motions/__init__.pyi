from .checking import inspect as inspect
from .faults import Fault as Fault
from .intensity import arias_times as arias_times, measure as measure
from .loading import load_motions as load_motions, read_motion as read_motion
from .motion import Motion as Motion, resample as resample, truncate as truncate
from .outline import are_copies as are_copies, outline_of as outline_of
from .suite import MotionSuite as MotionSuite
from .writing import write_suite as write_suite
