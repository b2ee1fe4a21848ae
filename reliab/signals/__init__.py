"""Noise, converters, filters and spectra of measured channels: once, for all rooms."""
