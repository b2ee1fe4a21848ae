"""The running error inside the loop of a test: the monitor as C and as an FMU."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
