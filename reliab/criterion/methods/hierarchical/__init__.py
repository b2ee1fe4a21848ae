"""All structures learned together: a model of earthquakes, motions and structures, sampled by MCMC."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
