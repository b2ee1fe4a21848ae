"""Report of a measured campaign: where the model fails, what is missing, and the proof."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
