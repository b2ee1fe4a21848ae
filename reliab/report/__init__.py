"""Figures and PDF reports of finished results; nothing is simulated here."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
