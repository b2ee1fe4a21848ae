"""`reliab validate`: whether criteria hold on motions that they have not seen."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
