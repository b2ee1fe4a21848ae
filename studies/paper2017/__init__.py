"""Guo and others (2017): what the paper prints, recomputed from its tables and from its records."""

from .audit import audit

__all__ = ["audit"]
