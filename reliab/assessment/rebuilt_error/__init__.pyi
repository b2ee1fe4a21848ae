from .force_form import Form as Form
from .identification import Identification as Identification, Identified as Identified, identify as identify
from .initial import (
    FEWEST_AT_REST as FEWEST_AT_REST,
    SHIFT_OF_COMMAND as SHIFT_OF_COMMAND,
    SIGNIFICANT_OFFSET as SIGNIFICANT_OFFSET,
)
from .loop_energy import (
    FALSE_ALARMS as FALSE_ALARMS,
    INDEPENDENT_SAMPLES as INDEPENDENT_SAMPLES,
    LARGE_MOTION as LARGE_MOTION,
    LARGEST_UNCERTAINTY as LARGEST_UNCERTAINTY,
    MEMORY as MEMORY,
    PLAY_FACTOR as PLAY_FACTOR,
    POLE_ITERATIONS as POLE_ITERATIONS,
    SINGULAR_DETERMINANT as SINGULAR_DETERMINANT,
    SLOWEST_POLE as SLOWEST_POLE,
    SMALLEST_FOLLOWING as SMALLEST_FOLLOWING,
    WatchedMode as WatchedMode,
    watched_modes as watched_modes,
)
from .nonlinear_reference import (
    rebuild_with_specimen as rebuild_with_specimen,
    tangent_structure as tangent_structure,
)
from .parts import Part as Part, Parts as Parts
from .readings import delayed as delayed, delayed_on as delayed_on
from .rebuild import (
    DRAWS as DRAWS,
    RebuiltError as RebuiltError,
    rebuild as rebuild,
)
from .recursion import Recursion as Recursion
from .running_error import Monitor as Monitor
from .running_specimen import (
    EQUATION_TOLERANCE as EQUATION_TOLERANCE,
    FORCE_TRIALS as FORCE_TRIALS,
    LONGEST_MEMORY as LONGEST_MEMORY,
    SMALLEST_DIVISOR as SMALLEST_DIVISOR,
    SMALLEST_SLOPE as SMALLEST_SLOPE,
    VELOCITY_NOISE as VELOCITY_NOISE,
)
from .running_test import (
    FALSE_ERROR_ALARMS as FALSE_ERROR_ALARMS,
    SHRINKING_SHARE as SHRINKING_SHARE,
    TIME_WITHOUT_DOUBLING as TIME_WITHOUT_DOUBLING,
    Now as Now,
    RunningResponse as RunningResponse,
    RunningSums as RunningSums,
    RunningTest as RunningTest,
    require_readings as require_readings,
)
from .specimen_check import (
    FEWEST_PERIODS as FEWEST_PERIODS,
    examine_specimen as examine_specimen,
)
from .spread import HALF_WIDTH as HALF_WIDTH, DisplacementError as DisplacementError, Estimate as Estimate
from .tolerances import Tolerances as Tolerances
from .widenings import Widening as Widening
