"""Probabilistic reliability workbench for real-time hybrid simulation."""

__version__ = "0.1.0"
