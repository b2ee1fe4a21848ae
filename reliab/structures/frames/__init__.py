"""Structures of many degrees of freedom: matrices, damping, shear and planar frames, modes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
