"""Contours of equal error and the curves that stand for them; what simulates is imported on first use."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
