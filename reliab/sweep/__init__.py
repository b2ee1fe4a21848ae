"""From a grid of actuators to a labelled dataset: storage, resume, clusters.

Everything is imported on first use, since reading ellipses needs neither kernels nor the storage library.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
