"""The explorer: one page with sliders for the tolerable region, which also judges a test file."""

from reliab.explore.page import Settings, write_page

__all__ = ["Settings", "write_page"]
