"""Transfer systems: what stands between the sent command and the piston's motion."""

from reliab.loop.transfer_systems.plant import Plant, TransferSystem
from reliab.loop.transfer_systems.servo_hydraulic import ServoHydraulic

__all__ = ["Plant", "ServoHydraulic", "TransferSystem"]
