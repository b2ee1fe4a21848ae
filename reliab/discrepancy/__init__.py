"""The discrepancy workflow."""
