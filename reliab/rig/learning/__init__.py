"""What the tests of a rig teach: a robust hierarchical model, beside two simpler ones."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
