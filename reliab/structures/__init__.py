"""Structures under test: one mass, frames, partitions, their specimens and their stability."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
