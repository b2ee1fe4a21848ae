"""Simulator of a hybrid test, as a closed loop or block by block."""

from reliab.simulation.compensators.compensator import Compensator
from reliab.simulation.hybrid_test.closed_loop import Histories, run_closed_loop
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import (
    Motion3,
    drive,
    follow,
    load,
    read_displacement,
    read_force,
)
from reliab.simulation.integrators.integrator import ExactIntegrator, Integrator, LinearSubstructure
from reliab.structures.specimen import Specimen

__all__ = [
    "Compensator",
    "ExactIntegrator",
    "Histories",
    "HybridTest",
    "Integrator",
    "LinearSubstructure",
    "Motion3",
    "Specimen",
    "drive",
    "follow",
    "load",
    "read_displacement",
    "read_force",
    "run_closed_loop",
]
