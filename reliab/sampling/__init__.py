"""Posteriors: exact ones of normal values, and ensembles of walkers with their diagnostics.

Nothing here knows what the parameters mean; criteria and diagnoses bring their own models.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
