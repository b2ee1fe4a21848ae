"""Transfer systems: the equipment between the sent command and the piston's motion."""

from reliab.simulation.transfer_systems.plant import Plant, TransferSystem
from reliab.simulation.transfer_systems.reading import read_matlab, transfer_function_of
from reliab.simulation.transfer_systems.servo_hydraulic import ServoHydraulic
from reliab.simulation.transfer_systems.transfer_function import (
    TransferFunction,
    TransferUncertainty,
    first_order_lag,
    gain_and_delay,
    second_order,
)

__all__ = [
    "Plant",
    "ServoHydraulic",
    "TransferFunction",
    "TransferSystem",
    "TransferUncertainty",
    "first_order_lag",
    "gain_and_delay",
    "read_matlab",
    "second_order",
    "transfer_function_of",
]
