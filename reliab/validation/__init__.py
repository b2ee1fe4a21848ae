"""Validation of the criterion: cross-validation, other rigs, and the verdict on a test."""
