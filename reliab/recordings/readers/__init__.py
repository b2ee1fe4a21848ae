"""Readers of a test's file, one format per file, chosen by what the file's first bytes say."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
