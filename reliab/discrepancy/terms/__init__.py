"""Physical terms outside the library, which give an unknown effect an expression."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

# modules of these names would hide what they hold
from reliab.discrepancy.terms.outside_terms import outside_terms as outside_terms  # noqa: E402
