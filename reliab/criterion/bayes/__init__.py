"""Bayesian fits: exact posteriors and ensemble sampling."""
