"""Declarative studies: one TOML file each, done in stages."""
