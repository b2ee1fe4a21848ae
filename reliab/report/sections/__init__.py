"""Sections that reports of several kinds share."""
