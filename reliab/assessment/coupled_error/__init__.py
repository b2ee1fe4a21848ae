"""The error of a test with several actuators: each interface displacement's, with intervals and parts."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
