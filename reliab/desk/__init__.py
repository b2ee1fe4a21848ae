"""The whole product in the browser, beside the rig and offline: pages that ask the Python interface.

Panel, which only the desk needs, is imported when the desk is started.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
