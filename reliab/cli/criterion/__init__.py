"""`reliab criterion`: how much amplitude error and delay a test may have."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
