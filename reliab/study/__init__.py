"""Declarative studies: a TOML file, run in stages, that ends in a report."""
