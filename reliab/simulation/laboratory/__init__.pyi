from .laboratory import Rig as Rig, Run as Run, Sensors as Sensors, run_laboratory as run_laboratory
