"""Spectra of the channels: noise, segments, smoothing, conversion, scales."""
