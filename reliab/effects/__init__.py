"""Effects that may be missing from the model of a hybrid test, one to a file."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
