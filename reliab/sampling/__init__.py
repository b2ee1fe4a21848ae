"""Posteriors: exact ones of normal values, and ensembles of walkers with their diagnostics.

Nothing here knows what the parameters mean; criteria and diagnoses bring their own models.
"""
