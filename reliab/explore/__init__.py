"""The explorer: one page on which the tolerable region follows sliders, and a dropped test is judged."""

from reliab.explore.page import Settings, write_page

__all__ = ["Settings", "write_page"]
