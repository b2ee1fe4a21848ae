"""Declarative studies: a TOML file, run in stages, that ends in a report."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
