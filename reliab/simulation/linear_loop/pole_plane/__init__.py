"""Solutions for all actuators of one structure and ground motion from the responses of a few poles."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
