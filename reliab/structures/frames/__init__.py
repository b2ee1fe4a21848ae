"""Structures of many degrees of freedom: matrices, damping, shear and planar frames, modes."""

from reliab.structures.frames.damping import modal_damping, rayleigh_damping
from reliab.structures.frames.frame import Frame, Modes, natural_modes
from reliab.structures.frames.planar_frame import PlanarFrame
from reliab.structures.frames.response import undivided_response
from reliab.structures.frames.shear_frame import shear_frame

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
