"""Structures divided for hybrid simulation: interface, specimen, stability, and engines for many actuators."""
