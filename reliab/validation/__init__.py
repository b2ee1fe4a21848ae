"""Validation: criteria on earthquakes that they were not learned from, other rigs, stated probabilities."""
