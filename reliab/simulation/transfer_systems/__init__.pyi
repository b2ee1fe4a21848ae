from .matlab_structure import (
    require_sound_structure as require_sound_structure,
    subsystem_of as subsystem_of,
)
from .reading import read_matlab as read_matlab, transfer_function_of as transfer_function_of
from .servo_hydraulic import ServoHydraulic as ServoHydraulic
from .transfer_function import (
    ActuatorMatrix as ActuatorMatrix,
    Plant as Plant,
    TransferFunction as TransferFunction,
    TransferSystem as TransferSystem,
    first_order_lag as first_order_lag,
    gain_and_delay as gain_and_delay,
    invertible as invertible,
)
