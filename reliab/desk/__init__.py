"""The whole product in the browser, beside the rig and offline: pages that ask the Python interface.

Panel, which only the desk needs, is imported when the desk is started.
"""
