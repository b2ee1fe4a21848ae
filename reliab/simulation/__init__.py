"""A hybrid test simulated: engines, effects in time, integrators, transfer systems."""
