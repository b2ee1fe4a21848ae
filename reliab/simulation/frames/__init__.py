"""Structures divided for hybrid simulation: interface, specimen, stability, engines for many actuators."""
