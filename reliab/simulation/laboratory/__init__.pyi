from .laboratory import Run as Run, run_laboratory as run_laboratory
from .rig import Rig as Rig, Sensors as Sensors
