"""Measured campaigns: locate a discrepancy, name the missing effect, add it, verify on held-out tests."""
