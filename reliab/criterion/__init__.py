"""Distributions, Bayesian fits, laws and the criterion."""
