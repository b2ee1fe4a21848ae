"""Uncertain quantities of a test, one in each file."""
