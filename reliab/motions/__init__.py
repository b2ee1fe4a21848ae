"""Ground motions: readers, catalogues, suites, resampling and measures of intensity."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
