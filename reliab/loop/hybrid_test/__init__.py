"""Simulator of a hybrid test, as a closed loop or block by block."""

from reliab.loop.hybrid_test.closed_loop import Histories, run_closed_loop
from reliab.loop.hybrid_test.compensator import Compensator
from reliab.loop.hybrid_test.integrator import ExactIntegrator, Integrator, LinearSubstructure
from reliab.loop.hybrid_test.model import HybridTest
from reliab.loop.hybrid_test.open_loop import Motion3, drive, follow, load, read_displacement, read_force
from reliab.loop.hybrid_test.specimen import Specimen

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
