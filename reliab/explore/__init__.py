"""The explorer: one page with sliders for the tolerable region, in which a test file is placed."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
