"""Candidate models of a block: their parameters, their fit, and the search among them."""
