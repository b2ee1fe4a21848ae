"""Laws of frequency and damping, one per file; each refuses use outside its validity."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
