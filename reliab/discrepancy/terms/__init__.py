"""Differences of clocks, and a damping that is not as stated: what no model is changed for."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
