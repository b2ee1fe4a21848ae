"""The explorer: one page with sliders for the tolerable region, in which a test file is placed."""
