"""Structures of many degrees of freedom: matrices, damping, shear and planar frames, modes."""

from reliab.loop.structures.damping import modal_damping, rayleigh_damping
from reliab.loop.structures.frame import Frame, Modes, natural_modes
from reliab.loop.structures.planar_frame import PlanarFrame
from reliab.loop.structures.response import undivided_response
from reliab.loop.structures.shear_frame import shear_frame

__all__ = [
    "Frame",
    "Modes",
    "PlanarFrame",
    "modal_damping",
    "natural_modes",
    "rayleigh_damping",
    "shear_frame",
    "undivided_response",
]
