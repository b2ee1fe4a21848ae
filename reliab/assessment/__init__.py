"""The verdict on a real test, and what is tolerable before one."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

# modules of these names would hide what they hold
from reliab.assessment.assess import assess as assess  # noqa: E402
from reliab.assessment.default_criterion import default_criterion as default_criterion  # noqa: E402
