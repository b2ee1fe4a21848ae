"""Structures divided for hybrid simulation: interface, specimen, stability, engines for many actuators."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
