"""Contours of equal error and the curves that stand for them; what simulates is imported on first use."""
