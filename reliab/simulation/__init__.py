"""A hybrid test simulated: engines, effects in time, compensators, integrators, transfer systems."""
