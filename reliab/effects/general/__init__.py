"""Physical terms of a general kind, which give an effect outside the library an expression."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

# modules of these names would hide what they hold
from reliab.effects.general.general_term import is_general as is_general  # noqa: E402
from reliab.effects.general.general_terms import (  # noqa: E402
    general_term as general_term,
    general_terms as general_terms,
)
