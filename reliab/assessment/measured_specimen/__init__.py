"""The error of a test whose specimen nobody can model: what it does is learned from its own force."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
