"""Structures of many degrees of freedom: matrices, damping, shear and planar frames, modes."""
