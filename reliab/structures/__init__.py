"""Structures under test: one mass, frames, partitions, their specimens and their stability."""
