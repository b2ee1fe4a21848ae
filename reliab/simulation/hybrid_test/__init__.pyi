from .closed_loop import Histories as Histories, run_closed_loop as run_closed_loop
from .model import HybridTest as HybridTest
from .model_file import (
    MODEL_FILE as MODEL_FILE,
    UpdatedModel as UpdatedModel,
    read_model as read_model,
    write_model as write_model,
)
from .open_loop import (
    Motion3 as Motion3,
    drive as drive,
    follow as follow,
    load as load,
    read_displacement as read_displacement,
    read_force as read_force,
)
from .stepping import STATES as STATES, call_all as call_all, plan as plan
