"""Candidate models of a block: their parameters, their fit, and the search among them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
