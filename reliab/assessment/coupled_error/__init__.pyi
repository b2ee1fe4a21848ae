from .coupled_error import (
    LOST_IN_NOISE as LOST_IN_NOISE,
    CoupledError as CoupledError,
    DegreeError as DegreeError,
)
from .ground_motion import ShownByGround as ShownByGround, compare_with_ground as compare_with_ground
from .monitor import CoupledMonitor as CoupledMonitor
from .rebuild import rebuild_coupled as rebuild_coupled
