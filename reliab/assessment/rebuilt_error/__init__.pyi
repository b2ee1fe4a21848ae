from .force_form import Form as Form
from .identification import Identification as Identification, Identified as Identified, identify as identify
from .initial import FEWEST as FEWEST, SIGNIFICANT as SIGNIFICANT, STANDS as STANDS
from .loop_energy import (
    FALSE_ALARMS as FALSE_ALARMS,
    FOLLOWS as FOLLOWS,
    GRANTED as GRANTED,
    INDEPENDENT as INDEPENDENT,
    LARGE_MOTION as LARGE_MOTION,
    MEMORY as MEMORY,
    SINGULAR as SINGULAR,
    SLOWEST as SLOWEST,
    TURNS as TURNS,
    UNSURE as UNSURE,
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
    CLOSE as CLOSE,
    FLATTEST as FLATTEST,
    LONGEST_MEMORY as LONGEST_MEMORY,
    NOISE_OF_SPEED as NOISE_OF_SPEED,
    TINY as TINY,
    TRIES as TRIES,
)
from .running_test import (
    CALM as CALM,
    FALSE_ERROR_ALARMS as FALSE_ERROR_ALARMS,
    SHRINKS as SHRINKS,
    Now as Now,
    RunningResponse as RunningResponse,
    RunningSums as RunningSums,
    RunningTest as RunningTest,
    require_readings as require_readings,
)
from .specimen_check import (
    FEWEST_PERIODS as FEWEST_PERIODS,
    SpecimenCheck as SpecimenCheck,
    examine_specimen as examine_specimen,
)
from .spread import HALF_WIDTH as HALF_WIDTH, DisplacementError as DisplacementError, Estimate as Estimate
from .stretches import ErrorSoFar as ErrorSoFar
from .tolerances import Tolerances as Tolerances
from .widenings import Widening as Widening
