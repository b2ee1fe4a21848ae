"""Measured campaigns: locate a discrepancy, name the missing effect, add it, verify on held-out tests."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

# modules of these names would hide what they hold
from reliab.discrepancy.diagnose import diagnose as diagnose  # noqa: E402
