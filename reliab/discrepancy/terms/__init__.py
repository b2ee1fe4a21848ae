"""Differences of clocks, and a damping that is not as stated: what no model is changed for."""
