"""Validation: criteria on earthquakes that they were not learned from, other rigs, stated probabilities."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
