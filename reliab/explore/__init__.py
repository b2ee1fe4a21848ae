"""The explorer: one page with sliders for the tolerable region."""
