"""A laboratory's memory: the tests of a rig, what they teach of it, the next one predicted, drift noticed."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
