"""Delay compensators and controllers that laboratories use, one per file."""
