"""What is not known exactly about a test, and how much of the interval of its error that makes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
