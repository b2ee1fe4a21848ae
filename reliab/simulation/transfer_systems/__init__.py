"""Transfer systems: the equipment between the sent command and the piston's motion."""
